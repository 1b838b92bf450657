# SPDX-License-Identifier: BSD-2-Clause
"""Symmetric 3 x 3 matrices."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from . import _random
from ._arrays import PRECISION, array, close, instance, rows, small
from .spatial import skew

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array

__all__ = ["Symmetric3"]

_ROWS = (0, 0, 1, 0, 1, 2)
_COLUMNS = (0, 1, 1, 2, 2, 2)


class Symmetric3:
    """A symmetric matrix by its entries (xx, xy, yy, xz, yz, zz).

    Symmetric3(), Symmetric3(matrix), Symmetric3(six entries), Symmetric3(xx, xy, yy, xz, yz, zz), Symmetric3(other).
    """

    __slots__ = ("_data",)
    __hash__ = None

    def __init__(self, *args: Any, I: Any = None, other: Any = None) -> None:  # noqa: E741
        args = args or tuple(x for x in (I, other) if x is not None)
        if not args:
            self._data = np.zeros(6)
        elif len(args) == 6:
            self._data = np.array(args, dtype=float)
        elif len(args) == 1 and isinstance(args[0], Symmetric3):
            self._data = args[0]._data.copy()
        elif len(args) == 1 and np.shape(args[0]) == (3, 3):
            self._data = _entries(args[0])
        elif len(args) == 1:
            self._data = array(args[0], (6,), "I").copy()
        else:
            raise TypeError(f"Symmetric3 takes 0, 1 or 6 arguments, not {len(args)}")

    @property
    def data(self) -> Array:
        """The entries (xx, xy, yy, xz, yz, zz), a view."""
        return self._data

    @data.setter
    def data(self, value: ArrayLike) -> None:
        self._data[:] = array(value, (6,), "data")

    @property
    def np(self) -> Array:
        return self.matrix()

    def matrix(self) -> Array:
        """Returns the matrix (3, 3)."""
        xx, xy, yy, xz, yz, zz = self._data.tolist()
        return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])

    def setZero(self) -> Self:
        self._data[:] = 0.0
        return self

    def setIdentity(self) -> Self:
        self._data[:] = (1.0, 0.0, 1.0, 0.0, 0.0, 1.0)
        return self

    def setRandom(self) -> Self:
        self._data[:] = _random.uniform(6)
        return self

    def setDiagonal(self, diag: ArrayLike) -> Array:
        """Sets the entries on the diagonal (3,); the others stay."""
        self._data[[0, 2, 5]] = array(diag, (3,), "diag")
        return self

    def fill(self, value: float) -> Self:
        self._data[:] = float(value)
        return self

    @staticmethod
    def Zero() -> Symmetric3:
        return Symmetric3()

    @staticmethod
    def Identity() -> Symmetric3:
        return Symmetric3().setIdentity()

    @staticmethod
    def Random() -> Symmetric3:
        """Returns a random matrix that is positive semidefinite."""
        L = np.tril(_random.uniform(3, 3))
        return Symmetric3(L @ L.T)

    @staticmethod
    def RandomPositive() -> Symmetric3:
        return Symmetric3.Random()

    def inverse(self, res: Optional[Array] = None) -> Optional[Array]:
        """Returns the inverse (3, 3), and writes it into res if given. Raises numpy.linalg.LinAlgError if there is none."""
        out = np.linalg.inv(self.matrix())
        if res is not None:
            res[:] = out
        return out

    def vtiv(self, v: ArrayLike) -> float:
        """Returns v' S v."""
        v = array(v, (3,), "v")
        return float(v @ self.matrix() @ v)

    @staticmethod
    def vxs(v: ArrayLike, S3: Symmetric3) -> Array:
        """Returns skew(v) S (3, 3)."""
        return skew(v) @ S3.matrix()

    @staticmethod
    def svx(v: ArrayLike, S3: Symmetric3) -> Array:
        """Returns S skew(v) (3, 3)."""
        return S3.matrix() @ skew(v)

    @staticmethod
    def rhsMult(S3: Symmetric3, vin: ArrayLike, vout: ArrayLike) -> None:
        """Writes S vin into vout (3,)."""
        vout[:] = S3.matrix() @ array(vin, (3,), "vin")

    def decomposeltI(self) -> Array:
        """Returns the matrix (3, 2) that rotate() of Pinocchio uses: the first two columns of S - zz 1, with the last row doubled."""
        xx, xy, yy, xz, yz, zz = self._data.tolist()
        return np.array([[xx - zz, xy], [xy, yy - zz], [2 * xz, 2 * yz]])

    def rotate(self, R: ArrayLike) -> Symmetric3:
        """Returns R S R'."""
        R = array(R, (3, 3), "R")
        return Symmetric3(R @ self.matrix() @ R.T)

    def isApprox(self, other: Symmetric3, prec: float = PRECISION) -> bool:
        return close(self._data, instance(other, Symmetric3, "other")._data, prec)

    def isZero(self, prec: float = PRECISION) -> bool:
        return small(self._data, prec)

    def __add__(self, other: Symmetric3) -> Symmetric3:
        return Symmetric3(self._data + _data_of(other))

    def __sub__(self, other: Symmetric3) -> Symmetric3:
        return Symmetric3(self._data - _data_of(other))

    def __iadd__(self, other: Symmetric3) -> Self:
        self._data += _data_of(other)
        return self

    def __isub__(self, other: Symmetric3) -> Self:
        self._data -= _data_of(other)
        return self

    def __imul__(self, factor: float) -> Self:
        self._data *= float(factor)
        return self

    def __mul__(self, v: ArrayLike) -> Array:
        return self.matrix() @ array(v, (3,), "v")

    def __eq__(self, other: Symmetric3) -> bool:
        return bool(np.array_equal(self._data, other._data)) if isinstance(other, Symmetric3) else NotImplemented

    def __array__(self, dtype: Any = None, copy: Any = None) -> Array:
        return np.asarray(self.matrix(), dtype=dtype)

    def copy(self) -> Symmetric3:
        return Symmetric3(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return Symmetric3(self)

    def __reduce__(self) -> tuple[Any, ...]:
        return Symmetric3, (self._data,)

    def __repr__(self) -> str:
        return rows(self.matrix())


def _entries(matrix):
    return array(matrix, (3, 3), "I")[_ROWS, _COLUMNS]


def _data_of(x):
    return x._data if isinstance(x, Symmetric3) else _entries(x)
