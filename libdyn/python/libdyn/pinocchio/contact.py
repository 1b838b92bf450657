# SPDX-License-Identifier: BSD-2-Clause
"""Forward dynamics and impacts under constraints that a program gives by their Jacobian."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from .convert import matrix, vector
from .dynamics import crba, nonLinearEffects

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array
    from .data import Data
    from .model import Model


def _arguments(names, arguments, named):
    """Returns a dictionary of arguments by name."""
    if len(arguments) > len(names):
        raise TypeError(f"too many arguments; they are {', '.join(names)}")
    return {**dict(zip(names, arguments)), **named}


def _factors(M, J, damping):
    """Returns M^-1 J^T, and J M^-1 J^T with the damping on its diagonal."""
    MinvJt = np.linalg.solve(M, J.T)
    return MinvJt, J @ MinvJt + float(damping) * np.eye(len(J))


def forwardDynamics(model: Model, data: Data, *arguments: Any, **named: Any) -> Array:
    """Solves M ddq + nle = tau + J^T lambda, J ddq + drift = 0 for ddq (nv,), which it returns, and lambda; also data.ddq, lambda_c.

    Arguments: q, v, tau, constraint_jacobian, constraint_drift, damping=0. Without q and v, data.M and data.nle are used.
    """
    with_state = len(arguments) + len(named) >= 5
    names = ("q", "v", "tau", "constraint_jacobian", "constraint_drift", "damping")
    given = _arguments(names if with_state else names[2:], arguments, named)
    J = matrix(given["constraint_jacobian"], None, model.nv, "forwardDynamics", "constraint_jacobian")
    drift = vector(given["constraint_drift"], len(J), "forwardDynamics", "constraint_drift")
    tau = vector(given["tau"], model.nv, "forwardDynamics", "tau")
    if with_state:
        crba(model, data, given["q"])
        nonLinearEffects(model, data, given["q"], given["v"])
    M, MinvJt, A = data.M, *_factors(data.M, J, given.get("damping", 0.0))
    free = np.linalg.solve(M, tau - data.nle)
    data.lambda_c = np.linalg.solve(A, -drift - J @ free)
    data.ddq = free + MinvJt @ data.lambda_c
    return data.ddq


def impulseDynamicsWithJacobian(model: Model, data: Data, *arguments: Any, **named: Any) -> Array:
    """Solves M (v_after - v) = J^T impulse, J v_after = -r J v for v_after (nv,), which it returns; also data.dq_after, impulse_c.

    Arguments: q, v_before, constraint_jacobian, restitution_coefficient=0, damping=0. Without q, data.M is used.
    """
    names = ("q", "v_before", "constraint_jacobian", "restitution_coefficient", "damping")
    second = np.shape(arguments[1]) if len(arguments) > 1 else ()
    with_state = "q" in named or not (len(second) == 2 and second[1] == model.nv)
    given = _arguments(names if with_state else names[1:], arguments, named)
    J = matrix(given["constraint_jacobian"], None, model.nv, "impulseDynamics", "constraint_jacobian")
    v = vector(given["v_before"], model.nv, "impulseDynamics", "v_before")
    if with_state:
        crba(model, data, given["q"])
    MinvJt, A = _factors(data.M, J, given.get("damping", 0.0))
    data.impulse_c = np.linalg.solve(A, -(1 + float(given.get("restitution_coefficient", 0.0))) * (J @ v))
    data.dq_after = v + MinvJt @ data.impulse_c
    return data.dq_after


def computeKKTContactDynamicMatrixInverse(model: Model, data: Data, q: ArrayLike, constraint_jacobian: ArrayLike, damping: ArrayLike = 0.0) -> Array:
    """Returns the inverse of [[M, J^T], [J, -damping]] (nv + rows, nv + rows)."""
    crba(model, data, q)
    return _inverse(model, data, constraint_jacobian, damping, "computeKKTContactDynamicMatrixInverse")


def getKKTContactDynamicMatrixInverse(model: Model, data: Data, constraint_jacobian: ArrayLike) -> Array:
    """Returns the inverse of [[M, J^T], [J, 0]] (nv + rows, nv + rows) with the data.M of the last forwardDynamics or crba."""
    return _inverse(model, data, constraint_jacobian, 0.0, "getKKTContactDynamicMatrixInverse")


def _inverse(model, data, J, damping, function):
    J = matrix(J, None, model.nv, function, "constraint_jacobian")
    return np.linalg.inv(np.block([[data.M, J.T], [J, -float(damping) * np.eye(len(J))]]))
