# SPDX-License-Identifier: BSD-2-Clause
"""Configuration spaces as objects: vector spaces, SO2, SO3, SE2, SE3 and their products. The groups compute by libdyn's joint of the same space."""

from __future__ import annotations

import functools
import math
import operator
from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn

from . import _random
from ._arrays import array

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from .. import ArgumentPosition
    from ._types import Array

__all__ = ["LieGroup", "R1", "R2", "R3", "Rn", "SE2", "SE3", "SO2", "SO3"]


class _VectorSpace:
    def __init__(self, n: int) -> None:
        self.nq = self.nv = operator.index(n)
        if self.nv < 0:
            raise ValueError(f"Rn: the dimension is {n}; it must not be negative")
        self.name = f"R^{n}"
        self.neutral = np.zeros(self.nq)

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Array:
        return q + v

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        return q1 - q0

    def d_integrate(self, q: ArrayLike, v: ArrayLike, by: ArgumentPosition) -> Array:
        return np.eye(self.nv)

    def d_difference(self, q0: ArrayLike, q1: ArrayLike, by: ArgumentPosition) -> Array:
        return np.eye(self.nv) if by == libdyn.ArgumentPosition.ARG1 else -np.eye(self.nv)

    def normalize(self, q: ArrayLike) -> Self:
        return q

    def random(self) -> Array:
        return _random.uniform(self.nq)

    def random_within(self, lower: ArrayLike, upper: ArrayLike) -> Any:
        return _between(lower, upper)


class _JointSpace:
    """The configuration space of a joint type with `linear` coordinates that are lengths and come first."""

    def __init__(self, name: str, joint_type: str, parameters: Any, linear: Any, random_rotation: Any) -> None:
        robot = libdyn.Model()
        robot.add_body("body", 0, libdyn.JointDescription("joint", joint_type, parameters), libdyn.Inertia(1.0, np.zeros(3), np.eye(3)))
        self._model = libdyn.compile(robot)
        self.name, self._linear, self._random_rotation = name, linear, random_rotation
        self.nq, self.nv = self._model.nq, self._model.nv
        self.neutral = libdyn.neutral(self._model)

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Array:
        return libdyn.integrate(self._model, q, v)

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        return libdyn.difference(self._model, q0, q1)

    def d_integrate(self, q: ArrayLike, v: ArrayLike, by: ArgumentPosition) -> Array:
        return libdyn.d_integrate(self._model, q, v, by)

    def d_difference(self, q0: ArrayLike, q1: ArrayLike, by: ArgumentPosition) -> Array:
        return libdyn.d_difference(self._model, q0, q1, by)

    def normalize(self, q: ArrayLike) -> Self:
        return libdyn.normalize(self._model, q)

    def random(self) -> Array:
        return np.concatenate([_random.uniform(self._linear), self._random_rotation()])

    def random_within(self, lower: ArrayLike, upper: ArrayLike) -> Array:
        return np.concatenate([_between(lower[: self._linear], upper[: self._linear]), self._random_rotation()])


def _between(lower, upper):
    if not (np.all(np.isfinite(lower)) and np.all(np.isfinite(upper))):
        raise ValueError("randomConfiguration: a limit of a vector space is not finite")
    return lower + (upper - lower) * (0.5 + 0.5 * _random.uniform(len(lower)))


def _random_angle():
    t = math.pi * _random.uniform(1)[0]
    return np.array([math.cos(t), math.sin(t)])


class LieGroup:
    """A configuration space. Points q have nq entries, tangent vectors v have nv. `*` makes products.

    Derivatives take tangent vectors to tangent vectors: dIntegrate_dq(q, v) is (nv, nv).
    """

    __hash__ = None

    def __init__(self, *factors: Any) -> None:
        self._factors = factors

    nq: int = property(lambda self: sum(f.nq for f in self._factors), doc="The number of entries of q.")
    nv: int = property(lambda self: sum(f.nv for f in self._factors), doc="The number of entries of v.")
    name: str = property(lambda self: " x ".join(f.name for f in self._factors))

    @property
    def neutral(self) -> Array:
        """The neutral element (nq,)."""
        return np.concatenate([np.zeros(0), *(f.neutral for f in self._factors)])

    def _parts(self, *vectors):
        """Yields each factor with its part of each vector; vectors are (name, array, "nq" or "nv")."""
        arrays = [array(x, (getattr(self, size),), name) for name, x, size in vectors]
        starts = [0] * len(arrays)
        for factor in self._factors:
            ends = [start + getattr(factor, size) for start, (_, _, size) in zip(starts, vectors)]
            yield (factor, *(x[start:end] for x, start, end in zip(arrays, starts, ends)))
            starts = ends

    def _joined(self, parts):
        return np.concatenate([np.zeros(0), *parts])

    def integrate(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns the point (nq,) that q reaches in unit time at constant v."""
        return self._joined(f.integrate(a, b) for f, a, b in self._parts(("q", q, "nq"), ("v", v, "nv")))

    def difference(self, q0: ArrayLike, q1: ArrayLike) -> Array:
        """Returns the v (nv,) for which integrate(q0, v) is q1."""
        return self._joined(f.difference(a, b) for f, a, b in self._parts(("q0", q0, "nq"), ("q1", q1, "nq")))

    def interpolate(self, q0: ArrayLike, q1: ArrayLike, u: ArrayLike) -> Array:
        """Returns integrate(q0, u difference(q0, q1))."""
        return self.integrate(q0, float(u) * self.difference(q0, q1))

    def distance(self, q0: ArrayLike, q1: ArrayLike) -> float:
        """Returns the norm of the difference."""
        return float(np.linalg.norm(self.difference(q0, q1)))

    def squaredDistance(self, q0: ArrayLike, q1: ArrayLike) -> float:
        return self.distance(q0, q1) ** 2

    def normalize(self, q: ArrayLike) -> Self:
        """Scales quaternions and (cos, sin) pairs to norm one. Changes q if it is an array, and returns the result."""
        out = self._joined(f.normalize(a) for f, a in self._parts(("q", q, "nq")))
        if isinstance(q, np.ndarray):
            q[...] = out.reshape(q.shape)
        return out

    def random(self) -> Array:
        """Returns a random point: vectors have entries between -1 and 1, rotations are uniform."""
        return self._joined(f.random() for f in self._factors)

    def randomConfiguration(self, lower: ArrayLike, upper: ArrayLike) -> Array:
        """Returns a random point whose lengths lie between the limits (nq,). Raises ValueError if one of these is not finite."""
        return self._joined(f.random_within(a, b) for f, a, b in self._parts(("lower", lower, "nq"), ("upper", upper, "nq")))

    def _blocks(self, blocks):
        out = np.zeros((self.nv, self.nv))
        start = 0
        for block in blocks:
            end = start + len(block)
            out[start:end, start:end] = block
            start = end
        return out

    def dIntegrate(self, q: ArrayLike, v: ArrayLike, arg: ArgumentPosition) -> Array:
        """Returns the derivative (nv, nv) of integrate by q (ARG0) or v (ARG1)."""
        return self._blocks(f.d_integrate(a, b, arg) for f, a, b in self._parts(("q", q, "nq"), ("v", v, "nv")))

    def dIntegrate_dq(self, q: ArrayLike, v: ArrayLike, left: Any = None, right: Any = None) -> Array:
        """Returns the derivative J by q; (q, v, self, A) returns J A and (q, v, A, self) returns A J, with an integer for self."""
        return _multiplied(self.dIntegrate(q, v, libdyn.ArgumentPosition.ARG0), left, right)

    def dIntegrate_dv(self, q: ArrayLike, v: ArrayLike, left: Any = None, right: Any = None) -> Array:
        """Returns the derivative J by v; (q, v, self, A) returns J A and (q, v, A, self) returns A J, with an integer for self."""
        return _multiplied(self.dIntegrate(q, v, libdyn.ArgumentPosition.ARG1), left, right)

    def dIntegrateTransport(self, q: ArrayLike, v: ArrayLike, J: ArrayLike, arg: ArgumentPosition) -> Array:
        """Returns dIntegrate(q, v, arg) J: columns at integrate(q, v) become columns at q."""
        return self.dIntegrate(q, v, arg) @ np.asarray(J, dtype=float)

    def dDifference(self, q0: ArrayLike, q1: ArrayLike, arg: ArgumentPosition, left: Any = None, right: Any = None) -> Array:
        """Returns the derivative J of difference by q0 (ARG0) or q1 (ARG1), multiplied as dIntegrate_dq does."""
        J = self._blocks(f.d_difference(a, b, arg) for f, a, b in self._parts(("q0", q0, "nq"), ("q1", q1, "nq")))
        return _multiplied(J, left, right)

    def __mul__(self, other: LieGroup) -> LieGroup:
        return LieGroup(*self._factors, *other._factors) if isinstance(other, LieGroup) else NotImplemented

    def __eq__(self, other: LieGroup) -> bool:
        return self.name == other.name if isinstance(other, LieGroup) else NotImplemented

    def __repr__(self) -> str:
        return f"<LieGroup {self.name}>"


def _multiplied(J, left, right):
    if left is None and right is None:
        return J
    if isinstance(left, int) and right is not None:
        return J @ np.asarray(right, dtype=float)
    if isinstance(right, int) and left is not None:
        return np.asarray(left, dtype=float) @ J
    raise TypeError("give a matrix and an integer that stands for the derivative, in the order of the product")


@functools.lru_cache(maxsize=None)
def _joint_space(name):
    return _JointSpace(name, *{
        "SO(2)": ("continuous", {"axis": [0, 0, 1]}, 0, _random_angle),
        "SO(3)": ("spherical", {}, 0, _random.quaternion),
        "SE(2)": ("planar", {}, 2, _random_angle),
        "SE(3)": ("free_flyer", {}, 3, _random.quaternion),
    }[name])  # fmt: skip


def Rn(n: int) -> LieGroup:
    """Returns the vector space of n coordinates."""
    return LieGroup(_VectorSpace(n))


def R1() -> LieGroup:
    return Rn(1)


def R2() -> LieGroup:
    return Rn(2)


def R3() -> LieGroup:
    return Rn(3)


def SO2() -> LieGroup:
    """Returns the rotations in the plane; q is (cos, sin), v an angle [rad]."""
    return LieGroup(_joint_space("SO(2)"))


def SO3() -> LieGroup:
    """Returns the rotations; q is (x, y, z, w), v a rotation vector [rad] in the moving frame."""
    return LieGroup(_joint_space("SO(3)"))


def SE2() -> LieGroup:
    """Returns the poses in the plane; q is (x, y, cos, sin), v is (vx, vy, w) in the moving frame."""
    return LieGroup(_joint_space("SE(2)"))


def SE3() -> LieGroup:
    """Returns the poses; q is (x, y, z, qx, qy, qz, qw), v a motion in the moving frame, linear part first."""
    return LieGroup(_joint_space("SE(3)"))
