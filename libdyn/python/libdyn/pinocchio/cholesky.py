# SPDX-License-Identifier: BSD-2-Clause
"""Factors M = U D U^T of the mass matrix of the last crba."""
import numpy as np

import libdyn as dyn

from .calls import prepare


def decompose(model, data):
    """Computes the factors; returns U (nv, nv), which data.U gives, too, beside data.D (nv,)."""
    c, d = prepare(model, data, "decompose")
    dyn.cholesky.decompose(c.model, d)
    for name in ("U", "D"):
        data.__dict__.pop(name, None)
    return data.U


def solve(model, data, v):
    """Returns M^-1 v, for a vector or the columns of a matrix. Call decompose first."""
    c, d = prepare(model, data, "solve")
    given = np.asarray(v, dtype=float)
    if given.ndim not in (1, 2) or len(given) != c.nv:
        raise ValueError(f"solve: v has shape {given.shape}, the model wants ({c.nv},) or ({c.nv}, any)")
    return c.rows_out(dyn.cholesky.solve(c.model, d, c.rows_in(given)))


def computeMinv(model, data):
    """Returns M^-1 (nv, nv); also data.Minv. Call decompose first."""
    data.Minv = solve(model, data, np.eye(model.nv))
    return data.Minv
