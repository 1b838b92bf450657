# SPDX-License-Identifier: BSD-2-Clause
"""Inverse and forward dynamics, the mass matrix, the Coriolis matrix and energies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import libdyn as dyn

from .calls import prepare
from .enums import Convention
from .kinematics import PLACEMENTS, forwardKinematics

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from ._types import Array
    from .data import Data
    from .model import Model
    from .spatial import Force

_FORCES = ("liMi", "joints", "v", "a_gf", "f", "h")


def rnea(model: Model, data: Data, q: ArrayLike, v: ArrayLike, a: ArrayLike, fext: Optional[Sequence[Force]] = None) -> Array:
    """Returns tau = M(q) a + C(q, v) v + g(q), minus the effect of fext (nv,) [N m, N]; also data.tau, v, a_gf, f, h.

    fext has one Force for each joint, the universe's first, in the joint's frame.
    """
    c, d = prepare(model, data, "rnea")
    q, v, a, forces = c.q_in(q, "rnea"), c.v_in(v, "rnea", "v"), c.v_in(a, "rnea", "a"), c.forces_in(fext, "rnea")
    tau = data.tau = c.v_out(dyn.rnea(c.model, d, q, v, a, fext=forces))
    data.note(_FORCES, data.state(q, v, a, forces))
    return tau


def nonLinearEffects(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns C(q, v) v + g(q) (nv,) [N m, N]; also data.nle, v, a_gf, f, h."""
    c, d = prepare(model, data, "nonLinearEffects")
    q, v = c.q_in(q, "nonLinearEffects"), c.v_in(v, "nonLinearEffects", "v")
    nle = data.nle = c.v_out(dyn.non_linear_effects(c.model, d, q, v))
    data.note(_FORCES, data.state(q, v))
    return nle


nle = nonLinearEffects


def computeGeneralizedGravity(model: Model, data: Data, q: ArrayLike) -> Array:
    """Returns g(q) (nv,) [N m, N]; also data.g."""
    c, d = prepare(model, data, "computeGeneralizedGravity")
    g = data.g = c.v_out(dyn.generalized_gravity(c.model, d, c.q_in(q, "computeGeneralizedGravity")))
    return g


def computeStaticTorque(model: Model, data: Data, q: ArrayLike, fext: Sequence[Force]) -> Array:
    """Returns the joint forces (nv,) that hold the robot still against gravity and fext; also data.tau."""
    c, d = prepare(model, data, "computeStaticTorque")
    forces = c.forces_in(fext, "computeStaticTorque")
    tau = data.tau = c.v_out(dyn.compute_static_torque(c.model, d, c.q_in(q, "computeStaticTorque"), forces))
    return tau


def aba(
    model: Model,
    data: Data,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    fext: Optional[Sequence[Force]] = None,
    convention: Convention = Convention.LOCAL,
) -> Array:
    """Returns ddq = M^-1 (tau - C v - g) with external forces as rnea takes them (nv,) [rad/s^2, m/s^2]; also data.ddq."""
    if isinstance(fext, Convention):
        fext = None
    c, d = prepare(model, data, "aba")
    q, v, tau, forces = c.q_in(q, "aba"), c.v_in(v, "aba", "v"), c.v_in(tau, "aba", "tau"), c.forces_in(fext, "aba")
    ddq = dyn.aba(c.model, d, q, v, tau, fext=forces)
    data.note((*PLACEMENTS, "v", "a_gf"), data.state(q, v, ddq, forces))
    data._aba = (q.copy(), v.copy(), tau.copy(), forces)
    ddq = data.ddq = c.v_out(ddq)
    return ddq


def crba(model: Model, data: Data, q: ArrayLike, convention: Convention = Convention.LOCAL) -> Array:
    """Returns M(q) (nv, nv), both triangles; also data.M, Ycrb."""
    c, d = prepare(model, data, "crba")
    q = c.q_in(q, "crba")
    M = data.M = c.square_out(dyn.crba(c.model, d, q))
    data.note((*PLACEMENTS, "Ycrb", "oYcrb", "J"), data.state(q))
    return M


def computeMinverse(model: Model, data: Data, q: Optional[ArrayLike] = None) -> Array:
    """Returns M^-1(q) (nv, nv), both triangles; also data.Minv. Without q, that of the last aba."""
    c, d = prepare(model, data, "computeMinverse")
    if q is None:
        if getattr(data, "_aba", None) is None:
            raise ValueError("computeMinverse: call aba(model, data, q, v, tau) first, or give q")
        q = data._aba[0]
    else:
        q = c.q_in(q, "computeMinverse")
    Minv = data.Minv = c.square_out(dyn.compute_minverse(c.model, d, q))
    return Minv


def computeCoriolisMatrix(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns the matrix C(q, v) (nv, nv) for which dM/dt - 2 C is skew; also data.C, J, dJ."""
    c, d = prepare(model, data, "computeCoriolisMatrix")
    q, v = c.q_in(q, "computeCoriolisMatrix"), c.v_in(v, "computeCoriolisMatrix", "v")
    C = data.C = c.square_out(dyn.compute_coriolis_matrix(c.model, d, q, v))
    data.note((*PLACEMENTS, "J", "dJ"), data.state(q, v))
    return C


def getCoriolisMatrix(model: Model, data: Data) -> Array:
    """Returns the Coriolis matrix (nv, nv) at the state of the last computeRNEADerivatives; also data.C."""
    c, d = prepare(model, data, "getCoriolisMatrix")
    state = data.source("dJ", "getCoriolisMatrix", "computeRNEADerivatives(model, data, q, v, a)")
    C = data.C = c.square_out(dyn.compute_coriolis_matrix(c.model, d, state.q, state.v_or_zero))
    return C


def computeKineticEnergy(model: Model, data: Data, q: Optional[ArrayLike] = None, v: Optional[ArrayLike] = None) -> float:
    """Returns v^T M v / 2 [J]; also data.kinetic_energy. Without q and v, at the state of the last forwardKinematics."""
    c, d, state = _energy_state(model, data, q, v, "computeKineticEnergy", "v")
    energy = data.kinetic_energy = dyn.compute_kinetic_energy(c.model, d, state.q, state.v_or_zero)
    return energy


def computePotentialEnergy(model: Model, data: Data, q: Optional[ArrayLike] = None) -> float:
    """Returns the potential energy [J]; also data.potential_energy. Without q, at the state of the last forwardKinematics."""
    c, d, state = _energy_state(model, data, q, None, "computePotentialEnergy", "oMi")
    energy = data.potential_energy = dyn.compute_potential_energy(c.model, d, state.q)
    return energy


def computeMechanicalEnergy(model: Model, data: Data, q: Optional[ArrayLike] = None, v: Optional[ArrayLike] = None) -> float:
    """Returns the sum of both energies [J]; also data.mechanical_energy, kinetic_energy, potential_energy."""
    energy = data.mechanical_energy = computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q)
    return energy


def _energy_state(model, data, q, v, function, field):
    c, d = prepare(model, data, function)
    if q is None:
        return c, d, data.source(field, function, "forwardKinematics(model, data, q, v)")
    forwardKinematics(model, data, q, v)
    return c, d, data.source("oMi", function, "")


def computeAllTerms(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> None:
    """Computes data.M, nle, J, dJ, com, vcom, Jcom, Ag, hg, Ig, kinetic_energy, potential_energy, and the fields of forwardKinematics(q, v)."""
    from .centroidal import ccrba
    from .com import centerOfMass, jacobianCenterOfMass

    crba(model, data, q)
    nonLinearEffects(model, data, q, v)
    jacobianCenterOfMass(model, data, q)
    ccrba(model, data, q, v)
    computeMechanicalEnergy(model, data, q, v)
    forwardKinematics(model, data, q, v)
    centerOfMass(model, data, q, v)
    data.note(("J", "dJ", "ov"), data.source("oMi", "computeAllTerms", ""))
