# SPDX-License-Identifier: BSD-2-Clause
"""Placements, velocities and accelerations of joints and frames."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from .calls import prepare
from .convert import index
from .elements import Elements
from .enums import LOCAL, LOCAL_WORLD_ALIGNED, WORLD
from .spatial import SE3, Motion

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from .data import Data
    from .model import Model

PLACEMENTS = ("oMi", "liMi", "joints")
_BY_LEVEL = (PLACEMENTS, (*PLACEMENTS, "v"), (*PLACEMENTS, "v", "a"))


def forwardKinematics(model: Model, data: Data, q: ArrayLike, v: Optional[ArrayLike] = None, a: Optional[ArrayLike] = None) -> None:
    """Computes the poses of all joints: data.oMi, liMi; with v their velocities, data.v; with a also their accelerations, data.a, without gravity."""
    c, _ = prepare(model, data, "forwardKinematics")
    if a is not None and v is None:
        raise TypeError("forwardKinematics: a without v; give v, too")
    q = c.q_in(q, "forwardKinematics")
    v = None if v is None else c.v_in(v, "forwardKinematics", "v")
    a = None if a is None else c.v_in(a, "forwardKinematics", "a")
    data.note(_BY_LEVEL[(v is not None) + (a is not None)], data.state(q, v, a))


def updateGlobalPlacements(model: Model, data: Data) -> None:
    """Computes data.oMi. forwardKinematics has done it already."""
    _kinematics(data, "updateGlobalPlacements")


def _kinematics(data, function, field="oMi"):
    before = {"oMi": "forwardKinematics(model, data, q)", "v": "forwardKinematics(model, data, q, v)"}
    return data.source(field, function, before.get(field, "forwardKinematics(model, data, q, v, a)"))


def _turned(x, pose, reference_frame):
    """Returns a motion that is given in local axes, in another reference; `pose` is that of the local frame in the world."""
    if reference_frame == LOCAL:
        return x
    if reference_frame == WORLD:
        return pose.act(x)
    if reference_frame == LOCAL_WORLD_ALIGNED:
        return Motion(pose.rotation @ x.linear, pose.rotation @ x.angular)
    raise ValueError(f"reference_frame must be LOCAL, WORLD or LOCAL_WORLD_ALIGNED, not {reference_frame}")


def getVelocity(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the spatial velocity of a joint [m/s, rad/s]."""
    joint_id = index(joint_id, model.njoints, "getVelocity", "joint_id")
    return _turned(data.v[joint_id], data.oMi[joint_id], reference_frame)


def getAcceleration(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the spatial acceleration of a joint [m/s^2, rad/s^2], without gravity."""
    joint_id = index(joint_id, model.njoints, "getAcceleration", "joint_id")
    return _turned(data.a[joint_id], data.oMi[joint_id], reference_frame)


def _classical(acceleration, velocity):
    """Returns an acceleration with the one of the point that moves with the body as linear part. Both are in the same axes at the same point."""
    return Motion(acceleration.linear + np.cross(velocity.angular, velocity.linear), acceleration.angular)


def getClassicalAcceleration(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the acceleration of a joint's origin, and that of its rotation [m/s^2, rad/s^2], without gravity."""
    velocity = getVelocity(model, data, joint_id, reference_frame)
    return _classical(getAcceleration(model, data, joint_id, reference_frame), velocity)


def updateFramePlacement(model: Model, data: Data, frame_id: int) -> SE3:
    """Computes data.oMf[frame_id] from the poses of the last forwardKinematics; returns it."""
    frame = model.frames[index(frame_id, model.nframes, "updateFramePlacement", "frame_id")]
    if len(data.oMf) != model.nframes:
        data.oMf = Elements(model.nframes, lambda _: SE3.Identity())
    placement = data.oMf[frame_id] = data.oMi[frame.parentJoint] * frame.placement
    return placement


def updateFramePlacements(model: Model, data: Data) -> None:
    """Computes data.oMf, the poses of all frames, from the poses of the last forwardKinematics."""
    oMi, frames = data.oMi, list(model.frames)
    data.oMf = Elements(len(frames), lambda k: oMi[frames[k].parentJoint] * frames[k].placement)


def framesForwardKinematics(model: Model, data: Data, q: ArrayLike) -> None:
    """Computes the poses of all joints and frames: data.oMi, liMi, oMf."""
    forwardKinematics(model, data, q)
    updateFramePlacements(model, data)


def _joint_and_placement(model, which, placement, function):
    """Returns the joint and the placement of a frame, which is given by its index or by joint and placement."""
    if placement is None:
        frame = model.frames[index(which, model.nframes, function, "frame_id")]
        return frame.parentJoint, frame.placement
    return index(which, model.njoints, function, "joint_id"), placement


def _split(arguments, reference_frame, function):
    """Returns (placement or None, reference) of the arguments after a joint or frame: [placement,] [reference_frame]."""
    placement = None
    if arguments and isinstance(arguments[0], SE3):
        placement, *arguments = arguments
    if len(arguments) > 1:
        raise TypeError(f"{function}: too many arguments")
    return placement, arguments[0] if arguments else reference_frame


def _frame_motion(x, model, data, which, arguments, reference_frame, function):
    placement, reference = _split(arguments, reference_frame, function)
    joint, placement = _joint_and_placement(model, which, placement, function)
    return _turned(placement.actInv(x[joint]), data.oMi[joint] * placement, reference)


def getFrameVelocity(model: Model, data: Data, frame_id: int, *arguments: Any, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the spatial velocity of a frame [m/s, rad/s]. Arguments: frame_id or joint_id, placement; then the reference frame."""
    return _frame_motion(data.v, model, data, frame_id, arguments, reference_frame, "getFrameVelocity")


def getFrameAcceleration(model: Model, data: Data, frame_id: int, *arguments: Any, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the spatial acceleration of a frame [m/s^2, rad/s^2], without gravity. Arguments as for getFrameVelocity."""
    return _frame_motion(data.a, model, data, frame_id, arguments, reference_frame, "getFrameAcceleration")


def getFrameClassicalAcceleration(model: Model, data: Data, frame_id: int, *arguments: Any, reference_frame: ReferenceFrame = LOCAL) -> Motion:
    """Returns the acceleration of a frame's origin, and that of its rotation [m/s^2, rad/s^2]. Arguments as for getFrameVelocity."""
    velocity = _frame_motion(data.v, model, data, frame_id, arguments, reference_frame, "getFrameClassicalAcceleration")
    return _classical(_frame_motion(data.a, model, data, frame_id, arguments, reference_frame, "getFrameClassicalAcceleration"), velocity)
