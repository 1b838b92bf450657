# SPDX-License-Identifier: BSD-2-Clause
"""Arguments of algorithms: arrays and indices."""
import numpy as np


def vector(x, size, function, name):
    """Returns x as an array (size,). Columns and rows of matrices count as vectors, as for Pinocchio. Raises ValueError, which names the argument."""
    if type(x) is not np.ndarray or x.ndim != 1:
        try:
            x = np.asarray(x, dtype=float)
        except (TypeError, ValueError):
            raise TypeError(f"{function}: {name} must be an array of numbers, not {type(x).__name__}") from None
        if x.ndim == 2 and 1 in x.shape:
            x = x.ravel()
    if x.shape != (size,):
        raise ValueError(f"{function}: {name} has shape {x.shape}, the model wants ({size},)")
    return x


def matrix(x, rows, columns, function, name):
    """Returns x as an array (rows, columns); None stands for any number. Raises ValueError, which names the argument."""
    x = np.asarray(x, dtype=float)
    if x.ndim != 2 or any(want is not None and have != want for have, want in zip(x.shape, (rows, columns))):
        raise ValueError(f"{function}: {name} has shape {x.shape}, the model wants ({rows or 'any'}, {columns or 'any'})")
    return x


def index(i, count, function, name):
    """Returns i if it is one of `count` indices. Raises ValueError, which names the argument."""
    i = int(i)
    if not 0 <= i < count:
        raise ValueError(f"{function}: {name} is {i}, the model has {count}")
    return i
