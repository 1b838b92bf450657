# SPDX-License-Identifier: BSD-2-Clause
"""Poses, motions and forces, with the names of Pinocchio. They are libdyn's own classes with more methods, so libdyn's functions take them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

import libdyn
from libdyn._core import _as

from . import _random
from ._arrays import PRECISION, array, close, instance, line, rows, small
from .rotations import Quaternion, coefficients_of

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Acted, Array

__all__ = ["Force", "Motion", "SE3", "SE3ToXYZQUAT", "SE3ToXYZQUATtuple", "XYZQUATToSE3", "classicAcceleration", "skew"]


def skew(u: ArrayLike) -> Array:
    """Returns the matrix (3, 3) with skew(u) x = u cross x."""
    x, y, z = array(u, (3,), "u").tolist()
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def own(x: Any) -> Any:
    """Returns a value of libdyn as this package's class for it. Other objects, such as arrays, are returned as they are."""
    cls = _OWN.get(type(x))
    return x if cls is None else _as(cls, x)


_OWN = {}
_act, _act_inverse, _inverse, _product = libdyn.SE3.act, libdyn.SE3.act_inverse, libdyn.SE3.inverse, libdyn.SE3.__mul__


class SE3(libdyn.SE3):
    """The pose aMb of frame b in frame a: x_a = rotation x_b + translation.

    SE3(), SE3(1), SE3(rotation, translation), SE3(quaternion, translation), SE3(homogeneous), SE3(other). Rotations are not checked.
    """

    __slots__ = ()

    def __init__(self, rotation: Any = None, translation: Any = None, *, quat: Any = None, array: Any = None, clone: Any = None) -> None:
        first = next((x for x in (rotation, quat, array, clone) if x is not None), None)
        if isinstance(first, libdyn.SE3):
            super().__init__(first)
            return
        if translation is not None:
            self._set(first.matrix() if isinstance(first, Quaternion) else first, translation)
            return
        super().__init__()
        if hasattr(first, "getRotation"):  # Transform3f of hppfcl
            self.rotation, self.translation = first.getRotation(), first.getTranslation()
        elif first is not None and not isinstance(first, int):
            self._read(first)

    def _set(self, rotation, translation):
        try:
            super().__init__(rotation, translation, check=False)
        except TypeError:
            super().__init__(array(rotation, (3, 3), "rotation"), array(translation, (3,), "translation"), check=False)

    def _read(self, homogeneous):
        H = array(homogeneous, (4, 4), "array")
        self.R[:] = H[:3, :3]
        self.p[:] = H[:3, 3]

    @property
    def rotation(self) -> Array:
        """The rotation (3, 3), a view: a change of it changes the pose."""
        return self.R

    @rotation.setter
    def rotation(self, value: ArrayLike) -> None:
        self.R[:] = array(value, (3, 3), "rotation")

    @property
    def translation(self) -> Array:
        """The origin of b in a (3,) [m], a view."""
        return self.p

    @translation.setter
    def translation(self, value: ArrayLike) -> None:
        self.p[:] = array(value, (3,), "translation")

    @property
    def np(self) -> Array:
        """The homogeneous matrix (4, 4), a new array."""
        return self.homogeneous

    @property
    def actionInverse(self) -> Array:
        """The 6 x 6 matrix that maps motions from a to b."""
        return _inverse(self).action

    @property
    def dualAction(self) -> Array:
        """The 6 x 6 matrix that maps forces from b to a."""
        return self.actionInverse.T

    def toHomogeneousMatrix(self) -> Array:
        return self.homogeneous

    def toActionMatrix(self) -> Array:
        return self.action

    def toActionMatrixInverse(self) -> Array:
        return self.actionInverse

    def toDualActionMatrix(self) -> Array:
        return self.dualAction

    def inverse(self) -> SE3:
        """Returns bMa."""
        return own(_inverse(self))

    __invert__ = inverse

    def act(self, x: Acted) -> Acted:
        """Maps a pose, motion, force, inertia or point (3,) from b to a."""
        return own(_product(self, x) if isinstance(x, libdyn.SE3) else _act(self, x))

    def actInv(self, x: Acted) -> Acted:
        """Maps a pose, motion, force, inertia or point (3,) from a to b."""
        return own(_inverse(self) * x if isinstance(x, libdyn.SE3) else _act_inverse(self, x))

    if TYPE_CHECKING:

        def __mul__(self, x: Acted) -> Acted: ...

    else:
        __mul__ = act

    def __matmul__(self, x: Acted) -> Acted:
        return self.act(x)

    def isApprox(self, other: SE3, prec: float = PRECISION) -> bool:
        instance(other, libdyn.SE3, "other")
        return close(self.R, other.R, prec) and close(self.p, other.p, prec)

    def isIdentity(self, prec: float = PRECISION) -> bool:
        return close(self.R, np.eye(3), prec) and small(self.p, prec)

    def setIdentity(self) -> Self:
        self.R[:] = np.eye(3)
        self.p[:] = 0.0
        return self

    def setRandom(self) -> Self:
        self.R[:] = libdyn.rotation_of(_random.quaternion())
        self.p[:] = _random.uniform(3)
        return self

    @staticmethod
    def Identity() -> SE3:
        return SE3()

    @staticmethod
    def Random() -> SE3:
        """Returns a pose with a uniformly random rotation and coordinates between -1 and 1."""
        return SE3().setRandom()

    @staticmethod
    def Interpolate(A: SE3, B: SE3, alpha: float) -> SE3:
        """Returns A exp6(alpha log6(A^-1 B))."""
        way = libdyn.SE3.log(_inverse(A) * B)
        return own(_product(A, libdyn.SE3.exp(float(alpha) * way)))

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.asarray(self.homogeneous, dtype=dtype)

    def copy(self) -> SE3:
        return _as(SE3, self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return _as(SE3, self)

    def __str__(self) -> str:
        return f"  R =\n{rows(self.R)}\n  p = {line(self.p)}\n"


class _Pair:
    """Methods of motions and forces."""

    __slots__ = ()

    def __init__(self, linear: Any = None, angular: Any = None, *, array: Any = None, clone: Any = None) -> None:
        first = next((x for x in (linear, array, clone) if x is not None), None)
        if first is None:
            super().__init__()
        elif angular is None:
            super().__init__(first)
        else:
            super().__init__(linear, angular)

    def __add__(self, other: Any) -> Any:
        return own(super().__add__(other))

    def __sub__(self, other: Any) -> Motion:
        return own(super().__sub__(other))

    def __neg__(self) -> Union[Force, Motion]:
        return own(super().__neg__())

    def __mul__(self, factor: Any) -> Any:
        return own(super().__mul__(factor))

    def __rmul__(self, factor: Any) -> Union[Force, Motion]:
        return own(super().__rmul__(factor))

    def __truediv__(self, divisor: float) -> Union[Force, Motion]:
        return type(self)(self.vector / float(divisor))

    def se3Action(self, M: SE3) -> Self:
        """Returns M.act(self)."""
        return own(_act(M, self))

    def se3ActionInverse(self, M: SE3) -> Self:
        """Returns M.actInv(self)."""
        return own(_act_inverse(M, self))

    def dot(self, other: Any) -> float:
        """Returns the power of a force along a motion, in the same frame."""
        instance(other, self._dual, "other")
        return float(self.vector @ other.vector)

    def isApprox(self, other: Any, prec: float = PRECISION) -> bool:
        instance(other, self._base, "other")
        return close(self.linear, other.linear, prec) and close(self.angular, other.angular, prec)

    def isZero(self, prec: float = PRECISION) -> bool:
        return small(self.vector, prec)

    def setZero(self) -> Self:
        self.vector = np.zeros(6)
        return self

    def setRandom(self) -> Self:
        self.vector = _random.uniform(6)
        return self

    @classmethod
    def Zero(cls) -> Self:
        return cls()

    @classmethod
    def Random(cls) -> Self:
        """Returns six numbers between -1 and 1."""
        return cls().setRandom()

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.array(self.vector, dtype=dtype)

    def copy(self) -> Self:
        return _as(type(self), self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return _as(type(self), self)


class Motion(_Pair, libdyn.Motion):
    """A spatial velocity or acceleration. Motion(), Motion(linear, angular), Motion(array of six), Motion(other)."""

    __slots__ = ()
    _base, _dual = libdyn.Motion, libdyn.Force

    @property
    def np(self) -> Array:
        """The six numbers, linear part first, a view."""
        return self.vector

    @property
    def action(self) -> Array:
        """The 6 x 6 matrix X with X m.vector = self.cross(m).vector."""
        w = skew(self.angular)
        return np.block([[w, skew(self.linear)], [np.zeros((3, 3)), w]])

    @property
    def dualAction(self) -> Array:
        """The 6 x 6 matrix X with X f.vector = self.cross(f).vector."""
        return -self.action.T

    @property
    def homogeneous(self) -> Array:
        """The 4 x 4 matrix [[skew(angular), linear], [0, 0]]."""
        out = np.zeros((4, 4))
        out[:3, :3] = skew(self.angular)
        out[:3, 3] = self.linear
        return out

    def cross(self, x: Acted) -> Acted:
        """Returns the derivative of a motion or force that is fixed in a frame that moves with this motion."""
        return own(super().cross(x))

    def __xor__(self, x: Acted) -> Acted:
        return self.cross(x) if isinstance(x, (libdyn.Motion, libdyn.Force)) else NotImplemented

    def __str__(self) -> str:
        return f"  v = {line(self.linear)}\n  w = {line(self.angular)}\n"


class Force(_Pair, libdyn.Force):
    """A spatial force or momentum. Force(), Force(linear, angular), Force(array of six), Force(other)."""

    __slots__ = ()
    _base, _dual = libdyn.Force, libdyn.Motion

    @property
    def np(self) -> Array:
        """The six numbers, linear part first, a view."""
        return self.vector

    def __str__(self) -> str:
        return f"  f = {line(self.linear)}\ntau = {line(self.angular)}\n"


_OWN.update({libdyn.SE3: SE3, libdyn.Motion: Motion, libdyn.Force: Force})


def classicAcceleration(spatial_velocity: Motion, spatial_acceleration: Motion, placement: Optional[SE3] = None) -> Array:
    """Returns the classical acceleration (3,) of the frame's origin, or of that of `placement` in the frame, in the frame of the arguments.

    With a placement, the result is in its axes.
    """
    v = instance(spatial_velocity, libdyn.Motion, "spatial_velocity")
    a = instance(spatial_acceleration, libdyn.Motion, "spatial_acceleration")
    if placement is not None:
        M = instance(placement, libdyn.SE3, "placement")
        v, a = M.act_inverse(v), M.act_inverse(a)
    return a.linear + np.cross(v.angular, v.linear)


def SE3ToXYZQUAT(M: SE3) -> Array:
    """Returns (x, y, z, qx, qy, qz, qw) as an array (7,)."""
    instance(M, libdyn.SE3, "M")
    return np.concatenate([M.p, coefficients_of(M.R)])


def SE3ToXYZQUATtuple(M: SE3) -> tuple[Any, ...]:
    """Returns (x, y, z, qx, qy, qz, qw) as a tuple."""
    return tuple(SE3ToXYZQUAT(M).tolist())


def XYZQUATToSE3(v: ArrayLike) -> SE3:
    """Returns the SE3 of (x, y, z, qx, qy, qz, qw). Raises ValueError for another size."""
    v = array(v, (7,), "v")
    return SE3(libdyn.rotation_of(v[3:]), v[:3])
