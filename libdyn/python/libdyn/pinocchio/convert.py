# SPDX-License-Identifier: BSD-2-Clause
"""Arguments of algorithms: arrays and indices."""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from ._arrays import array

if TYPE_CHECKING:
    from ._types import Array


def vector(x: Any, size: int, function: str, name: str) -> Array:
    """Returns x as an array (size,). Columns and rows of matrices count as vectors, as for Pinocchio. Raises an error that names the argument."""
    if type(x) is np.ndarray and x.shape == (size,) and x.dtype == float:
        return x
    return array(x, (size,), f"{function}: {name}")


def matrix(x: Any, rows: Optional[int], columns: Optional[int], function: str, name: str) -> Array:
    """Returns x as an array (rows, columns); None stands for any number. Raises ValueError, which names the argument."""
    x = np.asarray(x, dtype=float)
    if x.ndim != 2 or any(want is not None and have != want for have, want in zip(x.shape, (rows, columns))):
        raise ValueError(f"{function}: {name} has shape {x.shape}, the model wants ({rows or 'any'}, {columns or 'any'})")
    return x


def index(i: Any, count: int, function: str, name: str) -> int:
    """Returns i if it is one of `count` indices. Raises ValueError, which names the argument."""
    try:
        i = operator.index(i)
    except TypeError:
        raise TypeError(f"{function}: {name} must be an integer, not {type(i).__name__}") from None
    if not 0 <= i < count:
        raise ValueError(f"{function}: {name} is {i}, the model has {count}")
    return i
