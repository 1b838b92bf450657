# SPDX-License-Identifier: BSD-2-Clause
"""Dynamics of many states in threads, a state a column."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn as dyn

from .convert import matrix

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array
    from .data import Data
    from .model import Model


class ModelPool:
    """A model, with data for several threads. Arguments: a Model and the number of threads (by default that of the processor)."""

    def __init__(self, model: Model, size: Optional[int] = None) -> None:
        self._model, self._batch = model, None
        self.resize(omp_get_max_threads() if size is None else int(size))

    def size(self) -> int:
        """Returns the number of threads that have data."""
        return len(self._datas)

    def resize(self, new_size: int) -> None:
        """Makes data for another number of threads."""
        self._datas = [self._model.createData() for _ in range(new_size)]

    def getModel(self, index: int = 0) -> Model:
        """Returns the model, which all threads share."""
        return self._model

    def getModels(self) -> list[Model]:
        """Returns a list of the model, once for each thread."""
        return [self._model] * self.size()

    def getData(self, index: int) -> Data:
        """Returns the data of one thread."""
        return self._datas[index]

    def getDatas(self) -> list[Data]:
        """Returns the data of all threads."""
        return self._datas

    def batch(self, states: int, threads: int) -> Any:
        """Returns the compiled model and libdyn's data for a batch of states."""
        c = self._model.compiled()
        key = (c, states, threads)
        if self._batch is None or self._batch[0] != key:
            self._batch = (key, dyn.BatchData(c.model, max(states, 1), threads=threads))
        return c, self._batch[1]


def omp_get_max_threads() -> int:
    """Returns the number of threads that the processor runs at once."""
    return os.cpu_count() or 1


def _run(function, name, num_threads, pool, q, v, last, last_name, result):
    """Runs a function of libdyn for all columns; returns a matrix (nv, states), which is `result` if that is given."""
    model = pool.getModel()
    q = matrix(q, model.nq, None, name, "q")
    states = q.shape[1]
    v, last = matrix(v, model.nv, states, name, "v"), matrix(last, model.nv, states, name, last_name)
    if not 1 <= int(num_threads) <= pool.size():
        raise ValueError(f"{name}: num_threads is {num_threads}; the pool has data for 1 to {pool.size()}")
    c, batch = pool.batch(states, int(num_threads))
    out = function(c.model, batch, np.ascontiguousarray(c.rows_of_q(q).T), *(np.ascontiguousarray(c.rows_in(x).T) for x in (v, last)))
    out = c.rows_out(out.T)
    if result is None:
        return out
    if not isinstance(result, np.ndarray) or result.shape != out.shape:
        raise ValueError(f"{name}: the matrix for results must have shape {out.shape}")
    result[:] = out
    return result


def rneaInParallel(num_threads: int, pool: ModelPool, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: Optional[ArrayLike] = None) -> Array:
    """Returns rnea of many states (nv, states); q, v and a have a state a column. With tau, results are written there."""
    return _run(dyn.rnea, "rneaInParallel", num_threads, pool, q, v, a, "a", tau)


def abaInParallel(num_threads: int, pool: ModelPool, q: ArrayLike, v: ArrayLike, tau: ArrayLike, a: Optional[ArrayLike] = None) -> Array:
    """Returns aba of many states (nv, states); q, v and tau have a state a column. With a, results are written there."""
    return _run(dyn.aba, "abaInParallel", num_threads, pool, q, v, tau, "tau", a)
