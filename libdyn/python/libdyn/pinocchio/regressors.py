# SPDX-License-Identifier: BSD-2-Clause
"""Regressors: results as linear functions of the bodies' parameters, ten each (m, m c, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the joint's origin)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Optional

import numpy as np

import libdyn as dyn

from .calls import prepare
from .convert import index
from .enums import LOCAL, LOCAL_WORLD_ALIGNED, WORLD
from .kinematics import PLACEMENTS, _joint_and_placement
from .spatial import SE3, Motion

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from ._types import Array
    from .data import Data
    from .model import Model


def bodyRegressor(velocity: Motion, acceleration: Motion) -> Array:
    """Returns Y (6, 10): Y pi is the force on a body with the parameters pi that moves at this velocity and acceleration."""
    return dyn.body_regressor(Motion(velocity), Motion(acceleration))


def _moving(data, joint, function):
    data.source("a_gf", function, "rnea(model, data, q, v, a)")
    return data.v[joint], data.a_gf[joint]


def jointBodyRegressor(model: Model, data: Data, joint_id: int) -> Array:
    """Returns the bodyRegressor of a joint's body at the state of the last rnea."""
    return bodyRegressor(*_moving(data, index(joint_id, model.njoints, "jointBodyRegressor", "joint_id"), "jointBodyRegressor"))


def frameBodyRegressor(model: Model, data: Data, frame_id: int) -> Array:
    """Returns the bodyRegressor of a body in its frame at the state of the last rnea."""
    joint, placement = _joint_and_placement(model, frame_id, None, "frameBodyRegressor")
    return bodyRegressor(*(placement.actInv(x) for x in _moving(data, joint, "frameBodyRegressor")))


def computeStaticRegressor(model: Model, data: Data, q: ArrayLike) -> Array:
    """Returns Y (3, 4 (njoints - 1)): Y pi is the centre of mass, with parameters (m, m c) of each body; also data.staticRegressor."""
    c, _ = prepare(model, data, "computeStaticRegressor")
    state = data.state(c.q_in(q, "computeStaticRegressor"))
    data.note(PLACEMENTS, state)
    poses = [state.joint_pose(i) for i in range(1, c.njoints)]
    data.staticRegressor = np.hstack([np.hstack([M.translation[:, None], M.rotation]) for M in poses]) / c.model.mass
    return data.staticRegressor


def computeJointTorqueRegressor(model: Model, data: Data, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
    """Returns Y (nv, 10 (njoints - 1)): Y pi is rnea without armature; also data.jointTorqueRegressor."""
    c, d = prepare(model, data, "computeJointTorqueRegressor")
    name = "computeJointTorqueRegressor"
    Y = dyn.compute_joint_torque_regressor(c.model, d, c.q_in(q, name), c.v_in(v, name, "v"), c.v_in(a, name, "a"))
    data.jointTorqueRegressor = c.rows_out(c.blocks_out(Y, 10))
    return data.jointTorqueRegressor


def computeKineticEnergyRegressor(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns y (10 (njoints - 1),): y . pi is the kinetic energy [J]; also data.kineticEnergyRegressor."""
    c, d = prepare(model, data, "computeKineticEnergyRegressor")
    y = dyn.compute_kinetic_energy_regressor(
        c.model, d, c.q_in(q, "computeKineticEnergyRegressor"), c.v_in(v, "computeKineticEnergyRegressor", "v")
    )
    data.kineticEnergyRegressor = c.blocks_out(y, 10)
    return data.kineticEnergyRegressor


def computePotentialEnergyRegressor(model: Model, data: Data, q: ArrayLike) -> Array:
    """Returns y (10 (njoints - 1),): y . pi is the potential energy [J]; also data.potentialEnergyRegressor."""
    c, d = prepare(model, data, "computePotentialEnergyRegressor")
    y = dyn.compute_potential_energy_regressor(c.model, d, c.q_in(q, "computePotentialEnergyRegressor"))
    data.potentialEnergyRegressor = c.blocks_out(y, 10)
    return data.potentialEnergyRegressor


def computeJointKinematicRegressor(
    model: Model,
    data: Data,
    joint_id: int,
    reference_frame: ReferenceFrame,
    placement: Optional[SE3] = None,
) -> Array:
    """Returns Y (6, 6 (njoints - 1)): Y x is the displacement of a joint, or of `placement` in its frame, when the joint placements change by x.

    x has a motion for each joint, in the frame of the joint at its zero. The state is that of the last forwardKinematics.
    """
    joint_id = index(joint_id, model.njoints, "computeJointKinematicRegressor", "joint_id")
    state = data.source("oMi", "computeJointKinematicRegressor", "forwardKinematics(model, data, q)")
    return _kinematic(model, state, joint_id, SE3.Identity() if placement is None else placement, reference_frame)


def computeFrameKinematicRegressor(model: Model, data: Data, frame_id: int, reference_frame: ReferenceFrame) -> Array:
    """Returns Y (6, 6 (njoints - 1)): Y x is the displacement of a frame when the joint placements change by x."""
    joint, placement = _joint_and_placement(model, frame_id, None, "computeFrameKinematicRegressor")
    state = data.source("oMi", "computeFrameKinematicRegressor", "forwardKinematics(model, data, q)")
    return _kinematic(model, state, joint, placement, reference_frame)


def _kinematic(model, state, joint, placement, reference_frame):
    out = np.zeros((6, 6 * (model.njoints - 1)))
    frame = state.joint_pose(joint) * placement
    seen_from = {LOCAL: frame, WORLD: SE3.Identity(), LOCAL_WORLD_ALIGNED: SE3(np.eye(3), frame.translation)}[reference_frame]
    for i in model.supports[joint][1:]:
        at_zero = state.joint_pose(model.parents.items()[i]) * model.jointPlacements.items()[i]
        out[:, 6 * (i - 1) : 6 * i] = seen_from.actInv(at_zero).action
    return out
