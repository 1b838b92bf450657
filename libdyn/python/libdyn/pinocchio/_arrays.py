# SPDX-License-Identifier: BSD-2-Clause
"""Arguments that are arrays, and Eigen's comparison of two arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ._types import Array

PRECISION = 1e-12


def array(x: Any, shape: tuple[int, ...], name: str) -> Array:
    """Returns x as an array of float64 of this shape. Vectors may be columns or rows. Raises ValueError or TypeError that names the argument."""
    try:
        out = np.asarray(x, dtype=float)
    except (TypeError, ValueError):
        raise TypeError(f"{name} must be numbers of shape {shape}, not {type(x).__name__}") from None
    if out.shape != shape and len(shape) == 1 and out.ndim == 2 and out.shape in ((shape[0], 1), (1, shape[0])):
        out = out.reshape(shape)
    if out.shape != shape:
        raise ValueError(f"{name} has shape {out.shape}; it must have {shape}")
    return out


def instance(x: Any, cls: Any, name: str) -> Any:
    """Returns x. Raises TypeError that names the argument unless x is an instance of cls."""
    if not isinstance(x, cls):
        raise TypeError(f"{name} must be a {cls.__name__}, not {type(x).__name__}")
    return x


def call(function: Any, x: Any, shape: tuple[int, ...], name: str) -> Any:
    """Returns function(x). If the function does not take x as it is, x becomes an array first, which names the argument if that fails."""
    try:
        return function(x)
    except TypeError:
        return function(array(x, shape, name))


def close(a: Array, b: Array, prec: float = PRECISION) -> bool:
    """Returns whether the norm of a - b is at most prec times the smaller norm of the two."""
    d, a, b = (a - b).ravel(), a.ravel(), b.ravel()
    return bool(d @ d <= prec * prec * min(a @ a, b @ b))


def small(a: Array, prec: float = PRECISION) -> bool:
    """Returns whether no entry is larger than prec."""
    return bool(np.all(np.abs(a) <= prec))


def rows(matrix: Array) -> Array:
    """Returns the numbers of a matrix as text, a row a line."""
    return "\n".join(" ".join(f"{x:12.6g}" for x in row) for row in matrix.tolist())


def line(vector: Array) -> Array:
    """Returns the numbers of a vector as text."""
    return " ".join(f"{x:.6g}" for x in vector.tolist())
