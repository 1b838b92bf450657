# SPDX-License-Identifier: BSD-2-Clause
"""Inertias of rigid bodies and their parameters, with the names of Pinocchio."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

import libdyn

from . import _random
from ._arrays import PRECISION, array, close, instance, line, rows, small
from .spatial import _OWN, Motion, own
from .symmetric3 import Symmetric3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array
    from .spatial import Force, SE3

__all__ = ["Inertia", "LogCholeskyParameters", "PseudoInertia"]


class Inertia(libdyn.Inertia):
    """The inertia of a rigid body in the body's frame. Inertia(), Inertia(mass, lever, inertia), Inertia(other).

    mass [kg], lever: the centre of mass (3,) [m], inertia: the rotational inertia about it (3, 3) [kg m^2]. Raises ValueError for a negative mass
    and for a matrix that is not symmetric.
    """

    __slots__ = ()

    def __init__(self, mass: Any = None, lever: Any = None, inertia: Any = None, *, clone: Any = None) -> None:
        if lever is None and inertia is None:
            other = clone if clone is not None else mass
            super().__init__() if other is None else super().__init__(other)
            return
        if not mass >= 0:
            raise ValueError(f"mass is {mass}; it must not be negative")
        super().__init__(float(mass), array(lever, (3,), "lever"), array(inertia, (3, 3), "inertia"))

    @property
    def np(self) -> Array:
        """The matrix (6, 6) that maps a motion to a momentum, a new array."""
        return libdyn.Inertia.matrix.__get__(self)

    @property
    def lever(self) -> Array:
        """The centre of mass (3,) [m], a view."""
        return self.com

    @lever.setter
    def lever(self, value: ArrayLike) -> None:
        self.com[:] = array(value, (3,), "lever")

    @property
    def inertia(self) -> Array:
        """The rotational inertia about the centre of mass (3, 3) [kg m^2], a new array."""
        return self.rotational

    @inertia.setter
    def inertia(self, value: ArrayLike) -> None:
        self.rotational = array(value, (3, 3), "inertia")

    def matrix(self) -> Array:
        """Returns the matrix (6, 6) that maps a motion to a momentum."""
        return self.np

    def inverse(self) -> Array:
        """Returns the inverse of matrix() (6, 6). Raises numpy.linalg.LinAlgError if there is none."""
        rotational = np.linalg.inv(self.rotational)
        x, y, z = self.com.tolist()
        c = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        upper = c @ rotational
        return np.block([[np.eye(3) / self.mass - upper @ c, upper], [-rotational @ c, rotational]])

    def se3Action(self, M: SE3) -> Inertia:
        """Returns M.act(self)."""
        return own(libdyn.SE3.act(M, self))

    def se3ActionInverse(self, M: SE3) -> Inertia:
        """Returns M.actInv(self)."""
        return own(libdyn.SE3.act_inverse(M, self))

    def __add__(self, other: Inertia) -> Inertia:
        return own(super().__add__(other))

    def __iadd__(self, other: Inertia) -> Self:
        return self._assign(self + instance(other, libdyn.Inertia, "other"))

    def __sub__(self, other: Inertia) -> Inertia:
        """Returns the inertia that remains when `other`, a part of this body, is taken away."""
        if not isinstance(other, libdyn.Inertia):
            return NotImplemented
        mass = self.mass - other.mass
        if not mass > 0:
            return Inertia(0.0, np.zeros(3), self.rotational - other.rotational)
        lever = (self.mass * self.com - other.mass * other.com) / mass
        c = lever - other.com
        parallel = (mass * other.mass / self.mass) * (c @ c * np.eye(3) - np.outer(c, c))
        out = Inertia()
        out.mass, out.lever, out.inertia = mass, lever, self.rotational - other.rotational - parallel
        return out

    def __isub__(self, other: Inertia) -> Self:
        return self._assign(self - instance(other, libdyn.Inertia, "other"))

    def __mul__(self, motion: Motion) -> Force:
        """Returns the momentum of the body, a Force."""
        return own(libdyn.Inertia.__matmul__(self, motion))

    def __matmul__(self, motion: Motion) -> Force:
        return self * motion

    def vxiv(self, v: Motion) -> Force:
        """Returns v cross (self v), a Force."""
        return Motion(v).cross(self * v)

    def vtiv(self, v: Motion) -> float:
        """Returns v . (self v), twice the kinetic energy."""
        return (self * v).dot(v)

    def vxi(self, v: Motion) -> Array:
        """Returns the matrix (6, 6) of v cross self."""
        return Motion(v).dualAction @ self.np

    def ivx(self, v: Motion) -> Array:
        """Returns the matrix (6, 6) of self v cross."""
        return self.np @ Motion(v).action

    def variation(self, v: Motion) -> Array:
        """Returns the time derivative (6, 6) of matrix() in a frame that does not move with the body, whose velocity is v."""
        return self.vxi(v) - self.ivx(v)

    def _assign(self, other):
        self.mass, self.lever, self.inertia = other.mass, other.com, other.rotational
        return self

    def isApprox(self, other: Inertia, prec: float = PRECISION) -> bool:
        instance(other, libdyn.Inertia, "other")
        same = abs(self.mass - other.mass) <= prec and close(self.com, other.com, prec)
        return same and close(self.rotational, other.rotational, prec)

    def isZero(self, prec: float = PRECISION) -> bool:
        return abs(self.mass) <= prec and small(self.com, prec) and small(self.rotational, prec)

    def setZero(self) -> Self:
        return self._assign(Inertia())

    def setIdentity(self) -> Self:
        """Sets mass one, centre of mass zero, rotational inertia one."""
        return self._assign(Inertia.Identity())

    def setRandom(self) -> Self:
        return self._assign(Inertia.Random())

    @staticmethod
    def Zero() -> Inertia:
        return Inertia()

    @staticmethod
    def Identity() -> Inertia:
        return Inertia(1.0, np.zeros(3), np.eye(3))

    @staticmethod
    def Random() -> Inertia:
        return Inertia(1.0 + abs(_random.uniform(1)[0]), _random.uniform(3), Symmetric3.Random().matrix())

    @staticmethod
    def FromSphere(mass: float, radius: float) -> Inertia:
        """Returns the inertia of a ball [kg, m]."""
        return Inertia.FromEllipsoid(mass, radius, radius, radius)

    @staticmethod
    def FromEllipsoid(mass: float, length_x: float, length_y: float, length_z: float) -> Inertia:
        """Returns the inertia of an ellipsoid by its half axes [kg, m]."""
        return Inertia._diagonal(mass, _squares(length_x, length_y, length_z) * mass / 5)

    @staticmethod
    def FromBox(mass: float, length_x: float, length_y: float, length_z: float) -> Inertia:
        """Returns the inertia of a cuboid by its whole sides [kg, m]."""
        return Inertia._diagonal(mass, _squares(length_x, length_y, length_z) * mass / 12)

    @staticmethod
    def FromCylinder(mass: float, radius: float, length: float) -> Inertia:
        """Returns the inertia of a cylinder along z [kg, m]."""
        across = radius**2 / 4 + length**2 / 12
        return Inertia._diagonal(mass, mass * np.array([across, across, radius**2 / 2]))

    @staticmethod
    def FromCapsule(mass: float, radius: float, height: float) -> Inertia:
        """Returns the inertia of a capsule along z; `height` is between the centres of the two half balls [kg, m]."""
        # A half ball of radius r has its centre of mass 3 r / 8 from its plane, and 83/320 m r^2 about it, across the axis.
        cylinder = mass * height / (height + radius * 4 / 3)
        halves = mass - cylinder
        across = cylinder * (radius**2 / 4 + height**2 / 12) + halves * (radius**2 * 83 / 320 + (height / 2 + radius * 3 / 8) ** 2)
        return Inertia._diagonal(mass, np.array([across, across, cylinder * radius**2 / 2 + halves * radius**2 * 2 / 5]))

    @staticmethod
    def _diagonal(mass, moments):
        return Inertia(mass, np.zeros(3), np.diag(moments))

    def toDynamicParameters(self) -> Array:
        """Returns (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) (10,), with the rotational inertia about the frame's origin."""
        return libdyn.to_dynamic_parameters(self)

    @staticmethod
    def FromDynamicParameters(dynamic_parameters: ArrayLike) -> Inertia:
        return own(libdyn.inertia_from_dynamic_parameters(array(dynamic_parameters, (10,), "dynamic_parameters")))

    def toPseudoInertia(self) -> PseudoInertia:
        return PseudoInertia.FromInertia(self)

    @staticmethod
    def FromPseudoInertia(pseudo_inertia: PseudoInertia) -> Inertia:
        return pseudo_inertia.toInertia()

    @staticmethod
    def FromLogCholeskyParameters(log_cholesky_parameters: Union[LogCholeskyParameters, ArrayLike]) -> Inertia:
        return log_cholesky_parameters.toInertia()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.asarray(self.np, dtype=dtype)

    def copy(self) -> Inertia:
        return Inertia(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return Inertia(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, libdyn.Inertia):
            return NotImplemented
        return self.mass == other.mass and bool(np.all(self.com == other.com) and np.all(self.rotational == other.rotational))

    __hash__ = None

    def __str__(self) -> str:
        return f"  m = {self.mass:.6g}\n  c = {line(self.com)}\n  I = \n{rows(self.rotational)}"


_OWN[libdyn.Inertia] = Inertia


def _squares(x, y, z):
    return np.array([y * y + z * z, x * x + z * z, x * x + y * y])


class PseudoInertia:
    """The matrix [[sigma, h], [h', mass]] (4, 4), with sigma the sum of m x x' and h the first moment. PseudoInertia(mass, h, sigma)."""

    __slots__ = ("mass", "_h", "_sigma")
    __hash__ = None

    def __init__(self, mass: float, h: Optional[ArrayLike] = None, sigma: Optional[ArrayLike] = None) -> None:
        if isinstance(mass, PseudoInertia):
            mass, h, sigma = mass.mass, mass.h, mass.sigma
        self.mass, self.h, self.sigma = float(mass), h, sigma

    @property
    def h(self) -> Array:
        """The first moment (3,) [kg m], a view."""
        return self._h

    @h.setter
    def h(self, value: ArrayLike) -> None:
        self._h = array(value, (3,), "h").copy()

    @property
    def sigma(self) -> Array:
        """The second moments (3, 3) [kg m^2], a view."""
        return self._sigma

    @sigma.setter
    def sigma(self, value: ArrayLike) -> None:
        self._sigma = array(value, (3, 3), "sigma").copy()

    def toMatrix(self) -> Array:
        return np.block([[self.sigma, self.h[:, None]], [self.h[None, :], np.array([[self.mass]])]])

    @staticmethod
    def FromMatrix(pseudo_inertia_matrix: ArrayLike) -> PseudoInertia:
        J = array(pseudo_inertia_matrix, (4, 4), "pseudo_inertia_matrix")
        return PseudoInertia(J[3, 3], J[:3, 3], J[:3, :3])

    def toDynamicParameters(self) -> Array:
        return libdyn.dynamic_parameters_of_pseudo_inertia(self.toMatrix())

    @staticmethod
    def FromDynamicParameters(dynamic_parameters: ArrayLike) -> PseudoInertia:
        return PseudoInertia.FromMatrix(libdyn.pseudo_inertia(array(dynamic_parameters, (10,), "dynamic_parameters")))

    def toInertia(self) -> Inertia:
        return Inertia.FromDynamicParameters(self.toDynamicParameters())

    @staticmethod
    def FromInertia(inertia: Inertia) -> PseudoInertia:
        return PseudoInertia.FromDynamicParameters(libdyn.to_dynamic_parameters(inertia))

    def toLogCholeskyParameters(self) -> LogCholeskyParameters:
        return LogCholeskyParameters(libdyn.log_cholesky(self.toMatrix()))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.asarray(self.toMatrix(), dtype=dtype)

    def copy(self) -> PseudoInertia:
        return PseudoInertia(self)

    def __eq__(self, other: object) -> bool:
        return bool(np.array_equal(self.toMatrix(), other.toMatrix())) if isinstance(other, PseudoInertia) else NotImplemented

    def __reduce__(self) -> tuple[Any, ...]:
        return PseudoInertia, (self.mass, self.h, self.sigma)

    def __repr__(self) -> str:
        return f"  m = {self.mass:.6g}\n  h = {line(self.h)}\n  sigma = \n{rows(self.sigma)}"


class LogCholeskyParameters:
    """Ten numbers (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3) without bounds; all of them describe a real body (Rucker and Wensing 2022)."""

    __slots__ = ("_parameters",)
    __hash__ = None

    def __init__(self, log_cholesky_parameters: Union[LogCholeskyParameters, ArrayLike]) -> None:
        other = log_cholesky_parameters
        values = other.parameters if isinstance(other, LogCholeskyParameters) else other
        self._parameters = array(values, (10,), "log_cholesky_parameters").copy()

    @property
    def parameters(self) -> Array:
        return self._parameters

    def _matrix(self):
        return libdyn.pseudo_inertia_from_log_cholesky(self._parameters)

    def toDynamicParameters(self) -> Array:
        return libdyn.dynamic_parameters_of_pseudo_inertia(self._matrix())

    def toPseudoInertia(self) -> PseudoInertia:
        return PseudoInertia.FromMatrix(self._matrix())

    def toInertia(self) -> Inertia:
        return Inertia.FromDynamicParameters(self.toDynamicParameters())

    def calculateJacobian(self) -> Array:
        """Returns the derivative (10, 10) of toDynamicParameters() by the parameters."""
        alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3 = self._parameters.tolist()
        scale, diagonal = math.exp(alpha), [math.exp(d) for d in (d1, d2, d3)]
        U = scale * np.array([[diagonal[0], s12, s13, t1], [0, diagonal[1], s23, t2], [0, 0, diagonal[2], t3], [0, 0, 0, 1]])
        rates = [U]
        for (row, column), rate in zip(
            ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)), (*diagonal, 1, 1, 1, 1, 1, 1)
        ):
            dU = np.zeros((4, 4))
            dU[row, column] = scale * rate
            rates.append(dU)
        # The parameters are linear in the matrix, so the same function maps derivatives.
        return np.stack([libdyn.dynamic_parameters_of_pseudo_inertia(dU @ U.T + U @ dU.T) for dU in rates], axis=1)

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.array(self._parameters, dtype=dtype)

    def copy(self) -> LogCholeskyParameters:
        return LogCholeskyParameters(self)

    def __eq__(self, other: object) -> bool:
        return bool(np.array_equal(self._parameters, other._parameters)) if isinstance(other, LogCholeskyParameters) else NotImplemented

    def __reduce__(self) -> tuple[Any, ...]:
        return LogCholeskyParameters, (self._parameters,)

    def __repr__(self) -> str:
        return line(self._parameters)
