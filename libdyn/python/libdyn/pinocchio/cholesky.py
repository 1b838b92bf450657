# SPDX-License-Identifier: BSD-2-Clause
"""Factors M = U D U^T of the mass matrix of the last crba."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

import libdyn as dyn

from .calls import prepare

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array
    from .data import Data
    from .model import Model


def decompose(model: Model, data: Data) -> Array:
    """Computes the factors; returns U (nv, nv), which data.U gives, too, beside data.D (nv,)."""
    c, d = prepare(model, data, "decompose")
    dyn.cholesky.decompose(c.model, d)
    for name in ("U", "D"):
        data.__dict__.pop(name, None)
    return data.U


def solve(model: Model, data: Data, v: ArrayLike) -> Array:
    """Returns M^-1 v, for a vector or the columns of a matrix. Call decompose first."""
    c, d = prepare(model, data, "solve")
    given = np.asarray(v, dtype=float)
    if given.ndim not in (1, 2) or len(given) != c.nv:
        raise ValueError(f"solve: v has shape {given.shape}, the model wants ({c.nv},) or ({c.nv}, any)")
    return c.rows_out(dyn.cholesky.solve(c.model, d, c.rows_in(given)))


def computeMinv(model: Model, data: Data) -> Array:
    """Returns M^-1 (nv, nv); also data.Minv. Call decompose first."""
    data.Minv = solve(model, data, np.eye(model.nv))
    return data.Minv
