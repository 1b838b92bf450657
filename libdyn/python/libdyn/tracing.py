# SPDX-License-Identifier: BSD-2-Clause
"""Numbers that are unknown yet: a function that runs on them leaves its operations on a tape.

A function of a joint runs once on such scalars. It uses `+ - * / **`, `abs`, sin, cos, tan, exp, log, sqrt, atan2 and select of this package, and
numpy arrays of scalars. It cannot decide by `if` on a scalar: the tape has one line of operations for all values.
"""

import numbers
import sys
from typing import Any, NoReturn, Union

import numpy as np
from numpy.typing import NDArray

from ._core import SE3, Error
from ._errors import error

Array = NDArray[Any]  #: Of numbers, or of objects where some of them are traced.
Number = Union[float, "Scalar"]


def refusal(message: str) -> Error:
    """Returns an Error at the line that called this package."""
    frame = sys._getframe(1)
    while frame.f_back is not None and frame.f_code.co_filename.startswith(__file__.rsplit("/", 1)[0] + "/"):
        frame = frame.f_back
    file, line = frame.f_code.co_filename, frame.f_lineno
    return error("argument", message, file, line)


class Tape:
    """A list of operations, each (name, argument, ...), where arguments are numbers of earlier operations."""

    def __init__(self) -> None:
        self.nodes: list[tuple[Any, ...]] = []
        self.inputs = 0

    def record(self, *node: Any) -> "Scalar":
        """Adds an operation; returns its result."""
        self.nodes.append(node)
        return Scalar(self, len(self.nodes) - 1)

    def input(self, count: int) -> Array:
        """Returns an array of `count` unknown values."""
        out = np.empty(count, dtype=object)
        for k in range(count):
            out[k] = self.record("input", self.inputs + k)
        self.inputs += count
        return out

    def index(self, value: object) -> int:
        """Returns the number of the operation that gives `value`, a scalar or a known number."""
        if isinstance(value, Scalar):
            if value._tape is not self:
                raise refusal("a scalar of another function, or of an earlier call, cannot be used here")
            return value._index
        if isinstance(value, numbers.Real) or (isinstance(value, np.ndarray) and value.ndim == 0 and value.dtype != object):
            return self.record("constant", float(value))._index
        if isinstance(value, np.ndarray) and value.ndim == 0:
            return self.index(value.item())
        raise refusal(f"a {type(value).__name__} is no number")


class Condition:
    """The result of comparing scalars, which select() takes."""

    __slots__ = ("less", "than", "negated")

    def __init__(self, less: Number, than: Number, negated: bool = False) -> None:
        self.less, self.than, self.negated = less, than, negated

    def __bool__(self) -> NoReturn:
        raise refusal("a decision by a value that is unknown while the function is traced: use libdyn.select(condition, a, b)")


class Scalar:
    """A number that is unknown while a function is traced."""

    __slots__ = ("_tape", "_index")

    def __init__(self, tape: Tape, index: int) -> None:
        self._tape, self._index = tape, index

    def _record(self, name: str, *arguments: object) -> "Scalar":
        return self._tape.record(name, *(self._tape.index(x) for x in arguments))

    def _binary(self, name: str, a: object, b: object) -> "Scalar":
        # Arrays and poses apply the operation themselves.
        if not all(isinstance(x, (Scalar, numbers.Real)) for x in (a, b)):
            return NotImplemented
        return self._record(name, a, b)

    def __add__(self, other: Number) -> "Scalar":
        return self._binary("add", self, other)

    def __radd__(self, other: Number) -> "Scalar":
        return self._binary("add", other, self)

    def __sub__(self, other: Number) -> "Scalar":
        return self._binary("subtract", self, other)

    def __rsub__(self, other: Number) -> "Scalar":
        return self._binary("subtract", other, self)

    def __mul__(self, other: Number) -> "Scalar":
        return self._binary("multiply", self, other)

    def __rmul__(self, other: Number) -> "Scalar":
        return self._binary("multiply", other, self)

    def __truediv__(self, other: Number) -> "Scalar":
        return self._binary("divide", self, other)

    def __rtruediv__(self, other: Number) -> "Scalar":
        return self._binary("divide", other, self)

    def __neg__(self) -> "Scalar":
        return self._record("negate", self)

    def __pos__(self) -> "Scalar":
        return self

    def __abs__(self) -> "Scalar":
        return self._record("abs", self)

    def __pow__(self, exponent: float) -> "Scalar":
        if exponent == 0.5:
            return self.sqrt()
        if not isinstance(exponent, numbers.Real) or exponent != int(exponent) or abs(exponent) > 64:
            raise refusal("a power of a traced number must be a whole number up to 64, or 0.5; write exp(y * log(x)) for others")
        out, square, n = None, self, abs(int(exponent))
        while n:
            if n & 1:
                out = square if out is None else out * square
            n >>= 1
            if n:
                square = square * square
        if out is None:
            return self * 0 + 1
        return out if exponent > 0 else 1 / out

    def __lt__(self, other: Number) -> Condition:
        return Condition(self, other)

    def __gt__(self, other: Number) -> Condition:
        return Condition(other, self)

    def __le__(self, other: Number) -> Condition:
        return Condition(other, self, True)

    def __ge__(self, other: Number) -> Condition:
        return Condition(self, other, True)

    def __eq__(self, other: object) -> NoReturn:
        raise refusal("traced numbers are not compared by == or !=: use < with libdyn.select")

    __ne__ = __eq__
    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> NoReturn:
        raise refusal("a decision by a value that is unknown while the function is traced: use libdyn.select(condition, a, b)")

    def _number(self, *_: object) -> NoReturn:
        raise refusal("the value is unknown while the function is traced; use libdyn.sin and the like in place of math.sin")

    __float__ = __int__ = __index__ = __complex__ = __round__ = __floor__ = __ceil__ = __trunc__ = _number
    __mod__ = __rmod__ = __floordiv__ = __rfloordiv__ = _number

    # numpy calls these for the functions of the same names.
    def sin(self) -> "Scalar":
        """Returns the sine."""
        return self._record("sin", self)

    def cos(self) -> "Scalar":
        """Returns the cosine."""
        return self._record("cos", self)

    def tan(self) -> "Scalar":
        """Returns the tangent."""
        return self._record("tan", self)

    def exp(self) -> "Scalar":
        """Returns the exponential."""
        return self._record("exp", self)

    def log(self) -> "Scalar":
        """Returns the natural logarithm."""
        return self._record("log", self)

    def sqrt(self) -> "Scalar":
        """Returns the square root."""
        return self._record("sqrt", self)

    def __repr__(self) -> str:
        return f"<traced number {self._index}: {self._tape.nodes[self._index][0]}>"


def sin(x: Any) -> Any:
    """Returns the sine of x [rad], a number, an array or a traced number."""
    return np.sin(x)


def cos(x: Any) -> Any:
    """Returns the cosine of x [rad], a number, an array or a traced number."""
    return np.cos(x)


def tan(x: Any) -> Any:
    """Returns the tangent of x [rad], a number, an array or a traced number."""
    return np.tan(x)


def exp(x: Any) -> Any:
    """Returns e^x of a number, an array or a traced number."""
    return np.exp(x)


def log(x: Any) -> Any:
    """Returns the natural logarithm of a number, an array or a traced number."""
    return np.log(x)


def sqrt(x: Any) -> Any:
    """Returns the square root of a number, an array or a traced number."""
    return np.sqrt(x)


def atan2(y: Any, x: Any) -> Any:
    """Returns the angle [rad] of the point (x, y); the arguments are numbers or traced numbers."""
    traced = y if isinstance(y, Scalar) else x
    return traced._record("atan2", y, x) if isinstance(traced, Scalar) else np.arctan2(y, x)


def select(condition: Any, a: Any, b: Any) -> Any:
    """Returns a where the condition (x < y and the like) holds, else b. Both are computed."""
    if not isinstance(condition, Condition):
        return a if condition else b
    if np.ndim(a) or np.ndim(b):
        a, b = np.broadcast_arrays(np.asarray(a, dtype=object), np.asarray(b, dtype=object))
        out = np.empty(a.shape, dtype=object)
        for k in np.ndindex(a.shape):
            out[k] = select(condition, a[k], b[k])
        return out
    if condition.negated:
        a, b = b, a
    traced: Any = condition.less if isinstance(condition.less, Scalar) else condition.than
    return traced._record("select_less", condition.less, condition.than, a, b)


class TracedSE3:
    """A pose of traced numbers: x_a = R x_b + p, with arrays R (3, 3) and p (3,)."""

    __array_ufunc__ = None  # array @ pose must not be tried entry by entry

    def __init__(self, R: Any = None, p: Any = (0, 0, 0)) -> None:
        self.R = np.asarray(np.eye(3) if R is None else R, dtype=object)
        self.p = np.asarray(p, dtype=object)
        if self.R.shape != (3, 3) or self.p.shape != (3,):
            raise refusal(f"a pose needs R (3, 3) and p (3,); these have shapes {self.R.shape} and {self.p.shape}")

    def inverse(self) -> "TracedSE3":
        """Returns bMa."""
        return TracedSE3(self.R.T, -(self.R.T @ self.p))

    def act(self, point: Any) -> Array:
        """Maps a point from b to a."""
        moved: Array = self.R @ np.asarray(point, dtype=object) + self.p
        return moved

    def __matmul__(self, other: Any) -> Any:
        if isinstance(other, (SE3, TracedSE3)):
            return TracedSE3(self.R @ other.R, self.R @ other.p + self.p)
        return self.act(other)

    def __rmatmul__(self, other: Any) -> Any:
        return TracedSE3(other.R @ self.R, other.R @ self.p + other.p) if isinstance(other, SE3) else NotImplemented

    __mul__ = __matmul__
    __rmul__ = __rmatmul__


def _is_traced(*values: object) -> bool:
    return any(isinstance(x, Scalar) for value in values for x in np.ravel(np.asarray(value, dtype=object)))


def _skew(w: Array) -> Array:
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]], dtype=object)


def _rotation(w: Array) -> Array:
    """The rotation by |w| about w: I + A W + B W^2 with A = sin t / t, B = (1 - cos t) / t^2, t = |w|; by series where t < 1."""
    t2 = w @ w
    series_a: Any = 0
    series_b: Any = 0
    for k in reversed(range(11)):
        series_a = series_a * -t2 / ((2 * k + 2) * (2 * k + 3)) + 1
        series_b = series_b * -t2 / ((2 * k + 3) * (2 * k + 4)) + 1
    t = sqrt(t2)
    half = sin(0.5 * t) / t
    small = t2 < 1
    W = _skew(w)
    rotation: Array = np.eye(3) + select(small, series_a, sin(t) / t) * W + select(small, 0.5 * series_b, 2 * half * half) * (W @ W)
    return rotation


_translation, _rotation_of_numbers = SE3.translation, SE3.rotation


def translation(x: Any, y: Any, z: Any) -> Any:
    """Returns a pose without rotation, SE3 or, if a coordinate [m] is a traced number, TracedSE3."""
    return TracedSE3(p=[x, y, z]) if _is_traced(x, y, z) else _translation(x, y, z)


def rotation(vector: Any, angle: Any = None) -> Any:
    """Returns a rotation by |vector| [rad] about the vector, or by `angle` [rad] about it; TracedSE3 if a number is traced."""
    if angle is None:
        return TracedSE3(_rotation(np.asarray(vector, dtype=object))) if _is_traced(vector) else _rotation_of_numbers(vector)
    if not _is_traced(vector, angle):
        return _rotation_of_numbers(vector, angle)
    if _is_traced(vector):
        vector = np.asarray(vector, dtype=object)
        axis = vector / sqrt(vector @ vector)
    else:
        vector = np.asarray(vector, dtype=float)
        length = np.linalg.norm(vector)
        if vector.shape != (3,) or not 0 < length < np.inf:
            raise refusal("an axis is a vector of three numbers other than zero")
        axis = vector / length
    c, s = cos(angle), sin(angle)
    return TracedSE3(c * np.eye(3) + s * _skew(axis) + (1 - c) * np.outer(axis, axis))


# Type checkers see SE3's own functions of numbers: what is traced is Any to them.
SE3.translation = staticmethod(translation)  # type: ignore[assignment]
SE3.rotation = staticmethod(rotation)  # type: ignore[assignment]
