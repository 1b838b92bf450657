# SPDX-License-Identifier: BSD-2-Clause
"""Small helpers that scripts written for Pinocchio use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.linalg as npl

from .rpy import matrixToRpy, rotate, rpyToMatrix
from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array

__all__ = [
    "eye",
    "fromListToVectorOfString",
    "isapprox",
    "matrixToRpy",
    "mprint",
    "np",
    "npToTTuple",
    "npToTuple",
    "npl",
    "rand",
    "rotate",
    "rpyToMatrix",
    "zero",
]


def npToTTuple(M: ArrayLike) -> tuple[tuple[Any, ...], ...]:
    """Returns a matrix as a tuple of its rows, each a tuple or a number."""
    return tuple(tuple(row) if isinstance(row, list) else row for row in M.tolist())


def npToTuple(M: ArrayLike) -> tuple[Any, ...]:
    """Returns a vector, row or column as a tuple of numbers, another matrix as a tuple of tuples."""
    return tuple(M.ravel().tolist()) if M.ndim == 1 or 1 in M.shape else npToTTuple(M)


def eye(n: Any) -> Array:
    """Returns the unit matrix (n, n)."""
    return np.eye(n)


def zero(n: Any) -> Array:
    """Returns zeros of a size or shape."""
    return np.zeros(n)


def rand(n: Any) -> Array:
    """Returns numbers between 0 and 1 of a size or shape."""
    return np.random.rand(n) if isinstance(n, int) else np.random.rand(*n)


def isapprox(a: Any, b: Any, epsilon: float = 1e-6) -> bool:
    """Returns whether two numbers, arrays, lists or spatial quantities agree: numbers to epsilon, arrays as numpy.allclose with rtol=epsilon."""
    a, b = (getattr(x, "np", x) for x in (a, b))
    if isinstance(a, (np.ndarray, list)) and isinstance(b, (np.ndarray, list)):
        return np.allclose(np.squeeze(np.asarray(a)), np.squeeze(np.asarray(b)), epsilon)
    return abs(a - b) < epsilon


def mprint(M: Any, name: str = "ans", eps: float = 1e-15) -> None:
    """Prints a matrix, a vector or an SE3 in blocks of six columns. Numbers up to eps are written as 0."""
    matrix = np.atleast_2d(M.homogeneous if isinstance(M, SE3) else M)
    sizes = np.abs(matrix[np.abs(matrix) > eps])
    wide = sizes.size > 0 and (sizes.min() < 1e-5 or sizes.max() > 1e6 or sizes.max() / sizes.min() > 1e3)
    print(f"{name} = \n")
    for first in range(0, matrix.shape[1], 6):
        last = min(first + 6, matrix.shape[1])
        print(f"Columns {first} through {last - 1}\n")
        for row in matrix[:, first:last]:
            print("  " + "   ".join((f"{x: 10.3e}" if wide else f"{x: 10.5f}") if abs(x) > eps else " 0".ljust(10) for x in row))
        print()


def fromListToVectorOfString(items: list[str]) -> Any:
    """Returns the items as a StdVec_StdString."""
    from .containers import StdVec_StdString

    return StdVec_StdString(items)
