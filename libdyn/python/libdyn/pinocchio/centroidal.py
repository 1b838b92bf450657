# SPDX-License-Identifier: BSD-2-Clause
"""The momentum about the centre of mass, in world axes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

import libdyn as dyn

from .calls import prepare
from .kinematics import PLACEMENTS
from .spatial import Force

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._types import Array
    from .data import Data
    from .model import Model

_COMMON = (*PLACEMENTS, "J", "com", "mass", "Ig", "oYcrb")


def ccrba(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns Ag (6, nv), for which Ag v is the momentum; also data.Ag, hg, Ig, com, vcom, J."""
    c, d = prepare(model, data, "ccrba")
    q, v = c.q_in(q, "ccrba"), c.v_in(v, "ccrba", "v")
    hg, Ag = dyn.ccrba(c.model, d, q, v)
    data.hg, data.Ag = Force(hg), c.v_out(Ag)
    data.note((*_COMMON, "vcom"), data.state(q, v))
    return data.Ag


def computeCentroidalMap(model: Model, data: Data, q: ArrayLike) -> Array:
    """Returns Ag (6, nv), for which Ag v is the momentum; also data.Ag, Ig, com, J."""
    c, d = prepare(model, data, "computeCentroidalMap")
    q = c.q_in(q, "computeCentroidalMap")
    data.Ag = c.v_out(dyn.ccrba(c.model, d, q, np.zeros(c.nv))[1])
    data.note(_COMMON, data.state(q))
    return data.Ag


def dccrba(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns dAg (6, nv), the rate of Ag; also data.dAg, Ag, hg, Ig, com, vcom, J, dJ."""
    c, d = prepare(model, data, "dccrba")
    q, v = c.q_in(q, "dccrba"), c.v_in(v, "dccrba", "v")
    hg, _, Ag, dAg = dyn.compute_centroidal_momentum_time_variation(c.model, d, q, v, np.zeros(c.nv))
    data.hg, data.Ag, data.dAg = Force(hg), c.v_out(Ag), c.v_out(dAg)
    data.note((*_COMMON, "vcom", "dJ"), data.state(q, v))
    return data.dAg


computeCentroidalMapTimeVariation = dccrba


def computeCentroidalMomentum(model: Model, data: Data, q: Optional[ArrayLike] = None, v: Optional[ArrayLike] = None) -> Force:
    """Returns the momentum, a Force; also data.hg, com, vcom. Without q and v, at the state of the last forwardKinematics(q, v)."""
    c, d, state = _state(model, data, (q, v), "computeCentroidalMomentum", "v")
    data.hg = Force(dyn.ccrba(c.model, d, state.q, state.v_or_zero)[0])
    data.note(("com", "vcom", "mass"), state)
    return data.hg


def computeCentroidalMomentumTimeVariation(
    model: Model,
    data: Data,
    q: Optional[ArrayLike] = None,
    v: Optional[ArrayLike] = None,
    a: Optional[ArrayLike] = None,
) -> Force:
    """Returns the rate of the momentum, a Force; also data.dhg, hg, com, vcom, acom. Without q, v and a, at the last forwardKinematics(q, v, a)."""
    c, d, state = _state(model, data, (q, v, a), "computeCentroidalMomentumTimeVariation", "a")
    hg, dhg, *_ = dyn.compute_centroidal_momentum_time_variation(c.model, d, state.q, state.v_or_zero, state.a_or_zero)
    data.hg, data.dhg = Force(hg), Force(dhg)
    data.note(("com", "vcom", "acom", "mass"), state)
    return data.dhg


def _state(model, data, arguments, function, field):
    """Returns the compiled model, libdyn's data, and the state of the arguments or of the last forwardKinematics."""
    c, d = prepare(model, data, function)
    if arguments[0] is None:
        return c, d, data.source(field, function, f"forwardKinematics(model, data, q, v{', a' if field == 'a' else ''})")
    names = ("q", "v", "a")
    state = data.state(*(take(x, function, n) for take, x, n in zip((c.q_in, c.v_in, c.v_in), arguments, names)))
    data.note((*PLACEMENTS, *names[1 : len(arguments)]), state)
    return c, d, state


def computeCentroidalDynamicsDerivatives(model: Model, data: Data, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> tuple[Array, Array, Array, Array]:
    """Returns the derivatives (6, nv) of the momentum by q, and of its rate by q, v and a; also data.hg, dhg, Ag."""
    c, d = prepare(model, data, "computeCentroidalDynamicsDerivatives")
    names = ("q", "v", "a")
    q, v, a = (take(x, "computeCentroidalDynamicsDerivatives", n) for take, x, n in zip((c.q_in, c.v_in, c.v_in), (q, v, a), names))
    state = data.state(q, v, a)
    data.note((*PLACEMENTS, "v", "a", "ov", "oa", "J", "dJ", "com", "vcom", "Ig"), state)
    return _centroidal_derivatives(c, d, data, state)


def getCentroidalDynamicsDerivatives(model: Model, data: Data) -> tuple[Array, Array, Array, Array]:
    """Returns the same at the state of the last computeRNEADerivatives."""
    c, d = prepare(model, data, "getCentroidalDynamicsDerivatives")
    state = data.source("oa", "getCentroidalDynamicsDerivatives", "computeRNEADerivatives(model, data, q, v, a)")
    return _centroidal_derivatives(c, d, data, state)


def _centroidal_derivatives(c, d, data, state):
    hg, dhg, Ag, _ = dyn.compute_centroidal_momentum_time_variation(c.model, d, state.q, state.v_or_zero, state.a_or_zero)
    data.hg, data.dhg, data.Ag = Force(hg), Force(dhg), c.v_out(Ag)
    return tuple(c.v_out(x) for x in dyn.compute_centroidal_dynamics_derivatives(c.model, d, state.q, state.v_or_zero, state.a_or_zero))
