# SPDX-License-Identifier: BSD-2-Clause
"""Jacobians of joints and frames, and their rates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from .calls import prepare
from .convert import index
from .enums import LOCAL, WORLD
from .kinematics import PLACEMENTS, _joint_and_placement, _split
from .spatial import skew

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from ._types import Array
    from .data import Data
    from .model import Model
    from .spatial import SE3
    from .state import State


def computeJointJacobians(model: Model, data: Data, q: Optional[ArrayLike] = None) -> Array:
    """Returns the columns (6, nv) of all joints' Jacobians in WORLD; also data.J, oMi. Without q, at the state of the last forwardKinematics."""
    c, _ = prepare(model, data, "computeJointJacobians")
    if q is None:
        state = data.source("oMi", "computeJointJacobians", "forwardKinematics(model, data, q)")
    else:
        state = data.state(c.q_in(q, "computeJointJacobians"))
        data.note(PLACEMENTS, state)
    data.note(("J",), state)
    return data.J


def computeJointJacobiansTimeVariation(model: Model, data: Data, q: ArrayLike, v: ArrayLike) -> Array:
    """Returns the rates (6, nv) of the columns that computeJointJacobians returns; also data.dJ, J, oMi, v."""
    c, _ = prepare(model, data, "computeJointJacobiansTimeVariation")
    q, v = c.q_in(q, "computeJointJacobiansTimeVariation"), c.v_in(v, "computeJointJacobiansTimeVariation", "v")
    data.note((*PLACEMENTS, "v", "ov", "J", "dJ"), data.state(q, v))
    return data.dJ


def _jacobians(data, function):
    return data.source("J", function, "computeJointJacobians(model, data, q)")


def _rates(data, function):
    return data.source("dJ", function, "computeJointJacobiansTimeVariation(model, data, q, v)")


def computeJointJacobian(model: Model, data: Data, q: ArrayLike, joint_id: int) -> Array:
    """Returns the Jacobian (6, nv) of a joint, in LOCAL."""
    c, _ = prepare(model, data, "computeJointJacobian")
    joint_id = index(joint_id, model.njoints, "computeJointJacobian", "joint_id")
    return data.state(c.q_in(q, "computeJointJacobian")).joint_jacobian(joint_id, LOCAL)


def getJointJacobian(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the Jacobian (6, nv) of a joint at the state of the last computeJointJacobians."""
    joint_id = index(joint_id, model.njoints, "getJointJacobian", "joint_id")
    return _jacobians(data, "getJointJacobian").joint_jacobian(joint_id, reference_frame)


def getJointJacobianTimeVariation(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the rate (6, nv) of the Jacobian of a joint at the state of the last computeJointJacobiansTimeVariation."""
    joint_id = index(joint_id, model.njoints, "getJointJacobianTimeVariation", "joint_id")
    return _rates(data, "getJointJacobianTimeVariation").joint_jacobian_rate(joint_id, reference_frame)


def _turn(R, J):
    """Returns the columns of J in axes that R turns."""
    return np.vstack([R @ J[:3], R @ J[3:]])


def frame_jacobian_rate(state: State, joint: int, placement: SE3, reference_frame: ReferenceFrame) -> Array:
    """Returns the rate of the Jacobian of a frame."""
    if reference_frame == WORLD:
        return state.joint_jacobian_rate(joint, WORLD)
    action = placement.inverse().action
    rate = action @ state.joint_jacobian_rate(joint, LOCAL)
    if reference_frame == LOCAL:
        return rate
    J = action @ state.joint_jacobian(joint, LOCAL)
    turning = skew(placement.actInv(state.v()[joint]).angular)
    rate += np.vstack([turning @ J[:3], turning @ J[3:]])
    return _turn(state.joint_pose(joint).rotation @ placement.rotation, rate)


def computeFrameJacobian(model: Model, data: Data, q: ArrayLike, frame_id: int, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the Jacobian (6, nv) of a frame."""
    c, _ = prepare(model, data, "computeFrameJacobian")
    joint, placement = _joint_and_placement(model, frame_id, None, "computeFrameJacobian")
    state = data.state(c.q_in(q, "computeFrameJacobian"))
    data.note(PLACEMENTS, state)
    return state.jacobian_at(joint, placement, reference_frame)


def getFrameJacobian(model: Model, data: Data, frame_id: int, *arguments: Any, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the Jacobian (6, nv) of a frame at the state of the last computeJointJacobians.

    Arguments: frame_id, or joint_id and placement; then the reference frame.
    """
    placement, reference = _split(arguments, reference_frame, "getFrameJacobian")
    joint, placement = _joint_and_placement(model, frame_id, placement, "getFrameJacobian")
    return _jacobians(data, "getFrameJacobian").jacobian_at(joint, placement, reference)


def getFrameJacobianTimeVariation(model: Model, data: Data, frame_id: int, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the rate (6, nv) of the Jacobian of a frame at the state of the last computeJointJacobiansTimeVariation."""
    joint, placement = _joint_and_placement(model, frame_id, None, "getFrameJacobianTimeVariation")
    return frame_jacobian_rate(_rates(data, "getFrameJacobianTimeVariation"), joint, placement, reference_frame)


def frameJacobianTimeVariation(model: Model, data: Data, q: ArrayLike, v: ArrayLike, frame_id: int, reference_frame: ReferenceFrame = LOCAL) -> Array:
    """Returns the rate (6, nv) of the Jacobian of a frame at q and v."""
    computeJointJacobiansTimeVariation(model, data, q, v)
    return getFrameJacobianTimeVariation(model, data, frame_id, reference_frame)
