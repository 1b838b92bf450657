# SPDX-License-Identifier: BSD-2-Clause
"""Rotations as quaternions and as axis and angle, with the names of eigenpy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn

from . import _random
from ._arrays import PRECISION, array, close, instance

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array

__all__ = ["AngleAxis", "Quaternion"]


def coefficients_of(R: Any) -> Array:
    """Returns the unit quaternion (x, y, z, w) of a rotation matrix, with the sign that Eigen gives it.

    w is positive where the trace is positive. Elsewhere the component of the largest entry on the diagonal is positive.
    """
    q = libdyn.quaternion_of(R, check=False)
    if not R[0, 0] + R[1, 1] + R[2, 2] > 0:
        largest = 1 if R[1, 1] > R[0, 0] else 0
        if R[2, 2] > R[largest, largest]:
            largest = 2
        if q[largest] < 0:
            return -q
    return q


def _product(a, b):
    ax, ay, az, aw = a.tolist()
    bx, by, bz, bw = b.tolist()
    return np.array(
        [
            (aw * bx + ax * bw) + (ay * bz - az * by),
            (aw * by + ay * bw) + (az * bx - ax * bz),
            (aw * bz + az * bw) + (ax * by - ay * bx),
            (aw * bw - ax * bx) - (ay * by + az * bz),
        ]
    )


def _between(a, b):
    """Returns the coefficients of the shortest rotation that turns direction a into b."""
    a, b = array(a, (3,), "a"), array(b, (3,), "b")
    lengths = np.linalg.norm(a), np.linalg.norm(b)
    if not min(lengths) > 0:
        raise ValueError("FromTwoVectors: a direction is zero")
    a, b = a / lengths[0], b / lengths[1]
    axis = np.cross(a, b)
    half = np.append(axis, 1.0 + a @ b)
    if half[3] < 1e-7:  # half a turn: any axis across a; cancellation spoils the sum above
        axis = np.linalg.svd(np.vstack([a, b]))[2][2]
        w2 = max(half[3], 0.0) / 2
        return np.append(axis * np.sqrt(1 - w2), np.sqrt(w2))
    return half / np.linalg.norm(half)


class Quaternion:
    """A quaternion x i + y j + z k + w. coeffs() are (x, y, z, w).

    Quaternion(), Quaternion(w, x, y, z), Quaternion(R), Quaternion(axis_angle), Quaternion(coeffs), Quaternion(a, b) that turns a into b.
    """

    __slots__ = ("_c",)
    __hash__ = None

    def __init__(self, *args: Any, **named: Any) -> None:
        args += tuple(named.pop(k) for k in ("w", "x", "y", "z", "R", "aa", "quat", "u", "v", "vec4") if k in named)
        if named:
            raise TypeError(f"Quaternion has no argument {next(iter(named))}")
        if len(args) == 4:
            self._c = np.array([args[1], args[2], args[3], args[0]], dtype=float)
        elif len(args) == 2:
            self._c = _between(*args)
        elif not args:
            self._c = np.array([0.0, 0.0, 0.0, 1.0])
        elif len(args) == 1:
            self._c = self._read(args[0])
        else:
            raise TypeError(f"Quaternion takes 0, 1, 2 or 4 arguments, not {len(args)}")

    @staticmethod
    def _read(x):
        if isinstance(x, Quaternion):
            return x._c.copy()
        if isinstance(x, AngleAxis):
            return libdyn.exp3_quaternion(x.angle * x.axis)
        if np.shape(x) == (3, 3):
            return coefficients_of(np.asarray(x, dtype=float))
        return array(x, (4,), "quaternion").copy()

    def coeffs(self) -> Array:
        """Returns (x, y, z, w), a view: a change of it changes the quaternion."""
        return self._c

    def vec(self) -> Array:
        """Returns (x, y, z), a view."""
        return self._c[:3]

    def matrix(self) -> Array:
        """Returns the rotation matrix (3, 3); a norm other than one does not matter."""
        return libdyn.rotation_of(self._c)

    def toRotationMatrix(self) -> Array:
        return self.matrix()

    def _transformVector(self, vector):
        return self.matrix() @ array(vector, (3,), "vector")

    def norm(self) -> float:
        return float(np.linalg.norm(self._c))

    __abs__ = norm

    def squaredNorm(self) -> float:
        return float(self._c @ self._c)

    def normalize(self) -> Self:
        """Divides by the norm, in place; returns self. Raises ValueError for the zero quaternion."""
        largest = np.max(np.abs(self._c))
        if not largest > 0:
            raise ValueError("the zero quaternion has no direction")
        self._c /= largest
        self._c /= np.linalg.norm(self._c)
        return self

    def normalized(self) -> Quaternion:
        return Quaternion(self).normalize()

    def conjugate(self) -> Quaternion:
        x, y, z, w = self._c
        return Quaternion(w, -x, -y, -z)

    def inverse(self) -> Quaternion:
        """Returns the multiplicative inverse, conjugate / norm^2; zero for the zero quaternion."""
        out, n2 = self.conjugate(), self.squaredNorm()
        out._c = out._c / n2 if n2 > 0 else np.zeros(4)
        return out

    def setIdentity(self) -> Self:
        self._c[:] = (0.0, 0.0, 0.0, 1.0)
        return self

    def setRandom(self) -> Self:
        self._c[:] = _random.quaternion()
        return self

    def assign(self, other: Quaternion) -> Self:
        """Takes the value of a quaternion or an AngleAxis; returns self."""
        self._c[:] = self._read(other)
        return self

    def setFromTwoVectors(self, a: ArrayLike, b: ArrayLike) -> Self:
        """Becomes the shortest rotation that turns direction a into b; returns self."""
        self._c[:] = _between(a, b)
        return self

    def dot(self, other: Quaternion) -> float:
        return float(self._c @ instance(other, Quaternion, "other")._c)

    def angularDistance(self, other: Quaternion) -> float:
        """Returns the angle [rad] of the rotation between two unit quaternions, from 0 to pi."""
        instance(other, Quaternion, "other")
        return float(np.linalg.norm(libdyn.log3_quaternion(_product(self.conjugate()._c, other._c))))

    def slerp(self, t: float, other: Quaternion) -> Quaternion:
        """Returns the unit quaternion at t between self (0) and other (1), by the shorter way."""
        instance(other, Quaternion, "other")
        turn = libdyn.log3_quaternion(_product(self.conjugate()._c, other._c))
        return Quaternion(_product(self._c, libdyn.exp3_quaternion(t * turn)))

    def isApprox(self, other: Quaternion, prec: float = PRECISION) -> bool:
        return close(self._c, instance(other, Quaternion, "other")._c, prec)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, Quaternion):
            return Quaternion(_product(self._c, other._c))
        if isinstance(other, AngleAxis):
            return self * Quaternion(other)
        return self._transformVector(other)

    def __eq__(self, other: Quaternion) -> bool:
        return bool(np.array_equal(self._c, other._c)) if isinstance(other, Quaternion) else NotImplemented

    def __len__(self) -> int:
        return 4

    def __getitem__(self, k: int) -> float:
        return float(self._c[k])

    def __setitem__(self, k: int, value: float) -> None:
        self._c[k] = value

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.array(self._c, dtype=dtype)

    def copy(self) -> Quaternion:
        return Quaternion(self)

    def __copy__(self) -> Self:
        return Quaternion(self)

    def __deepcopy__(self, memo: Any) -> Self:
        return Quaternion(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Quaternion, (self._c,)

    def __repr__(self) -> str:
        return "(x,y,z,w) = " + " ".join(f"{x:.6g}" for x in self._c.tolist())

    @staticmethod
    def Identity() -> Quaternion:
        return Quaternion()

    @staticmethod
    def Random() -> Quaternion:
        return Quaternion().setRandom()

    @staticmethod
    def FromTwoVectors(a: ArrayLike, b: ArrayLike) -> Quaternion:
        """Returns the shortest rotation that turns direction a into b. Where they are opposite, the axis is any across a."""
        return Quaternion(a, b)


def _component(index):
    return property(lambda self: float(self._c[index]), lambda self, value: self._c.__setitem__(index, value))


for _index, _name in enumerate("xyzw"):
    setattr(Quaternion, _name, _component(_index))


class AngleAxis:
    """A rotation by an angle [rad] about a unit axis. AngleAxis(angle, axis), AngleAxis(R), AngleAxis(quaternion)."""

    __slots__ = ("angle", "_axis")
    __hash__ = None

    def __init__(
        self,
        first: Any = None,
        axis: Any = None,
        *,
        angle: Optional[float] = None,
        R: Any = None,
        quaternion: Any = None,
        copy: Any = None,
    ) -> None:
        first = next((x for x in (first, angle, R, quaternion, copy) if x is not None), None)
        if axis is not None:
            self.angle, self.axis = float(first), axis
        elif isinstance(first, AngleAxis):
            self.angle, self.axis = first.angle, first.axis
        elif isinstance(first, Quaternion):
            self._take(libdyn.log3_quaternion(first.coeffs()))
        elif first is None:
            self._take(np.zeros(3))
        else:
            self.fromRotationMatrix(first)

    def _take(self, vector):
        self.angle = float(np.linalg.norm(vector))
        self.axis = vector / self.angle if self.angle > 0 else np.array([1.0, 0.0, 0.0])

    @property
    def axis(self) -> Array:
        """The axis (3,), a view."""
        return self._axis

    @axis.setter
    def axis(self, value: ArrayLike) -> None:
        self._axis = array(value, (3,), "axis").copy()

    def fromRotationMatrix(self, R: Any) -> AngleAxis:
        """Takes the rotation of a matrix; the angle is then between 0 and pi. Returns self."""
        self._take(libdyn.log3(array(R, (3, 3), "R"), check=False))
        return self

    def matrix(self) -> Array:
        return libdyn.exp3(self.angle * self._axis)

    def toRotationMatrix(self) -> Array:
        return self.matrix()

    def inverse(self) -> AngleAxis:
        return AngleAxis(-self.angle, self._axis)

    def isApprox(self, other: AngleAxis, prec: float = PRECISION) -> bool:
        instance(other, AngleAxis, "other")
        return abs(self.angle - other.angle) <= prec * min(abs(self.angle), abs(other.angle)) and close(self._axis, other._axis, prec)

    def __mul__(self, other: Any) -> Any:
        if isinstance(other, (AngleAxis, Quaternion)):
            return Quaternion(self) * Quaternion(other)
        return self.matrix() @ array(other, (3,), "vector")

    def __eq__(self, other: Quaternion) -> bool:
        return self.angle == other.angle and np.array_equal(self._axis, other._axis) if isinstance(other, AngleAxis) else NotImplemented

    def __reduce__(self) -> tuple[Any, ...]:
        return AngleAxis, (self.angle, self._axis)

    def __repr__(self) -> str:
        return f"angle: {self.angle:.6g}\naxis: " + " ".join(f"{x:.6g}" for x in self._axis.tolist())
