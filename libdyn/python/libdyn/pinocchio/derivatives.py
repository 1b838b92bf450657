# SPDX-License-Identifier: BSD-2-Clause
"""Analytical derivatives of dynamics and kinematics. Derivatives by q are in its tangent space."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn as dyn

from .calls import prepare
from .convert import index
from .enums import LOCAL, LOCAL_WORLD_ALIGNED, WORLD
from .kinematics import PLACEMENTS, _joint_and_placement, _split

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from ._types import Array
    from .data import Data
    from .model import Model
    from .spatial import Force, SE3

_STATE = (*PLACEMENTS, "v", "ov", "a", "oa", "oa_gf", "of", "oh", "J", "dJ", "oYcrb")


def computeRNEADerivatives(
    model: Model,
    data: Data,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    fext: Optional[Sequence[Force]] = None,
) -> tuple[Array, Array, Array]:
    """Returns the derivatives (nv, nv) of rnea by q, v and a; also data.dtau_dq, dtau_dv, M, tau."""
    c, d = prepare(model, data, "computeRNEADerivatives")
    q, v, a = c.q_in(q, "computeRNEADerivatives"), c.v_in(v, "computeRNEADerivatives", "v"), c.v_in(a, "computeRNEADerivatives", "a")
    forces = c.forces_in(fext, "computeRNEADerivatives")
    dtau_dq, dtau_dv, M = map(c.square_out, dyn.compute_rnea_derivatives(c.model, d, q, v, a, fext=forces))
    data.tau = c.v_out(dyn.rnea(c.model, d, q, v, a, fext=forces))
    data.dtau_dq, data.dtau_dv, data.M = dtau_dq, dtau_dv, M
    data.note(_STATE, data.state(q, v, a, forces))
    return dtau_dq, dtau_dv, M


def computeGeneralizedGravityDerivatives(model: Model, data: Data, q: ArrayLike) -> Array:
    """Returns the derivative (nv, nv) of g(q)."""
    c, d = prepare(model, data, "computeGeneralizedGravityDerivatives")
    zero = np.zeros(c.nv)
    return c.square_out(dyn.compute_rnea_derivatives(c.model, d, c.q_in(q, "computeGeneralizedGravityDerivatives"), zero, zero)[0])


def computeStaticTorqueDerivatives(model: Model, data: Data, q: ArrayLike, fext: Sequence[Force]) -> Array:
    """Returns the derivative (nv, nv) of computeStaticTorque by q."""
    c, d = prepare(model, data, "computeStaticTorqueDerivatives")
    zero, forces = np.zeros(c.nv), c.forces_in(fext, "computeStaticTorqueDerivatives")
    return c.square_out(dyn.compute_rnea_derivatives(c.model, d, c.q_in(q, "computeStaticTorqueDerivatives"), zero, zero, fext=forces)[0])


def computeABADerivatives(model: Model, data: Data, *arguments: Any) -> tuple[Array, Array, Array]:
    """Returns the derivatives (nv, nv) of aba by q, v and tau; also data.ddq_dq, ddq_dv, Minv, ddq.

    Arguments: q, v, tau, or nothing for the state of the last aba; then fext, as for rnea.
    """
    c, d = prepare(model, data, "computeABADerivatives")
    if len(arguments) >= 3:
        names = ("q", "v", "tau")
        q, v, tau = (take(x, "computeABADerivatives", n) for take, x, n in zip((c.q_in, c.v_in, c.v_in), arguments, names))
        fext = arguments[3:]
    elif getattr(data, "_aba", None) is not None:
        q, v, tau, _ = data._aba
        fext = arguments
    else:
        raise ValueError("computeABADerivatives: call aba(model, data, q, v, tau) first, or give q, v and tau")
    forces = c.forces_in(fext[0] if fext else None, "computeABADerivatives")
    ddq_dq, ddq_dv, Minv, ddq = dyn.compute_aba_derivatives(c.model, d, q, v, tau, fext=forces)
    data.ddq_dq, data.ddq_dv, data.Minv, data.ddq = c.square_out(ddq_dq), c.square_out(ddq_dv), c.square_out(Minv), c.v_out(ddq)
    data.note(_STATE, data.state(q, v, ddq, forces))
    return data.ddq_dq, data.ddq_dv, data.Minv


def computeForwardKinematicsDerivatives(model: Model, data: Data, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> None:
    """Prepares the derivatives that the functions below return; also the fields of forwardKinematics, data.J and dJ."""
    c, _ = prepare(model, data, "computeForwardKinematicsDerivatives")
    names = ("q", "v", "a")
    q, v, a = (take(x, "computeForwardKinematicsDerivatives", n) for take, x, n in zip((c.q_in, c.v_in, c.v_in), (q, v, a), names))
    state = data.state(q, v, a)
    data.note((*PLACEMENTS, "v", "ov", "a", "oa", "J", "dJ"), state)
    data._derivatives = state


def _derivatives_of(model, data, joint, reference, function, name):
    """Returns what a function of libdyn returns for a joint at the prepared state."""
    c, _ = prepare(model, data, name)
    state = getattr(data, "_derivatives", None)
    if state is None or state.c is not c:
        raise ValueError(f"{name}: call computeForwardKinematicsDerivatives(model, data, q, v, a) first")
    joint = c.last[index(joint, model.njoints, name, "joint_id")]
    return state, [c.v_out(x) for x in function(c.model, state.derivatives(), joint, reference)]


def _at(model, data, joint, placement, reference, function, name):
    """Returns derivatives of a motion at `placement` in the frame of a joint.

    In LOCAL_WORLD_ALIGNED the point is held while the body moves, as in Pinocchio: these are the derivatives in WORLD, seen at the point.
    """
    if reference == LOCAL:
        _, parts = _derivatives_of(model, data, joint, LOCAL, function, name)
        action = None if placement is None else placement.inverse().action
        return tuple(parts if action is None else (action @ x for x in parts))
    state, parts = _derivatives_of(model, data, joint, WORLD, function, name)
    if reference == LOCAL_WORLD_ALIGNED:
        pose = state.joint_pose(joint)
        point = (pose if placement is None else pose * placement).translation
        parts = [np.vstack([x[:3] - np.cross(point, x[3:].T).T, x[3:]]) for x in parts]
    return tuple(parts)


def getJointVelocityDerivatives(model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame) -> tuple[Array, Array]:
    """Returns the derivatives (6, nv) of the velocity of a joint by q and v."""
    return _at(model, data, joint_id, None, reference_frame, dyn.get_joint_velocity_derivatives, "getJointVelocityDerivatives")


def getJointAccelerationDerivatives(
    model: Model, data: Data, joint_id: int, reference_frame: ReferenceFrame
) -> tuple[Array, Array, Array, Array]:
    """Returns the derivative (6, nv) of the velocity of a joint by q, and those of its acceleration by q, v and a."""
    return _at(model, data, joint_id, None, reference_frame, dyn.get_joint_acceleration_derivatives, "getJointAccelerationDerivatives")


def _of_frame(model, data, which, arguments, reference_frame, function, name):
    placement, reference = _split(arguments, reference_frame, name)
    joint, placement = _joint_and_placement(model, which, placement, name)
    return _at(model, data, joint, placement, reference, function, name)


def getFrameVelocityDerivatives(
    model: Model,
    data: Data,
    frame_id: int,
    *arguments: Any,
    reference_frame: ReferenceFrame = LOCAL,
) -> tuple[Array, Array]:
    """Returns the derivatives (6, nv) of the velocity of a frame by q and v. Arguments: frame_id, or joint_id and placement; then the reference."""
    return _of_frame(model, data, frame_id, arguments, reference_frame, dyn.get_joint_velocity_derivatives, "getFrameVelocityDerivatives")


def getFrameAccelerationDerivatives(
    model: Model,
    data: Data,
    frame_id: int,
    *arguments: Any,
    reference_frame: ReferenceFrame = LOCAL,
) -> tuple[Array, Array, Array, Array]:
    """Returns the derivative (6, nv) of the velocity of a frame by q, and those of its acceleration by q, v and a. Arguments as above."""
    name = "getFrameAccelerationDerivatives"
    return _of_frame(model, data, frame_id, arguments, reference_frame, dyn.get_joint_acceleration_derivatives, name)


def _linear_part(state, joint, placement, reference, motion, parts):
    """Returns derivatives (3, nv) of a point's vector from LOCAL ones of shape (3, nv); motion is the vector itself in LOCAL."""
    if reference == LOCAL:
        return parts
    if reference != LOCAL_WORLD_ALIGNED:
        raise ValueError("reference_frame must be LOCAL or LOCAL_WORLD_ALIGNED")
    turning = (placement.inverse().action @ state.joint_jacobian(joint, LOCAL))[3:]
    R = state.joint_pose(joint).rotation @ placement.rotation
    first = parts[0] + np.cross(turning.T, motion).T
    return [R @ x for x in (first, *parts[1:])]


def getPointVelocityDerivatives(model: Model, data: Data, joint_id: int, placement: SE3, reference_frame: ReferenceFrame) -> tuple[Array, Array]:
    """Returns the derivatives (3, nv) of the velocity of a point, the origin of `placement` in the frame of a joint, by q and v."""
    name = "getPointVelocityDerivatives"
    dq, dv = (x[:3] for x in _at(model, data, joint_id, placement, LOCAL, dyn.get_joint_velocity_derivatives, name))
    state = data._derivatives
    velocity = placement.actInv(state.v()[joint_id]).linear
    return tuple(_linear_part(state, joint_id, placement, reference_frame, velocity, [dq, dv]))


def getPointClassicAccelerationDerivatives(
    model: Model,
    data: Data,
    joint_id: int,
    placement: SE3,
    reference_frame: ReferenceFrame,
) -> tuple[Array, Array, Array, Array]:
    """Returns the derivative (3, nv) of the velocity of a point by q, and those of its classical acceleration by q, v and a."""
    name = "getPointClassicAccelerationDerivatives"
    v_dq, a_dq, a_dv, a_da = _at(model, data, joint_id, placement, LOCAL, dyn.get_joint_acceleration_derivatives, name)
    state = data._derivatives
    v, a = placement.actInv(state.v()[joint_id]), placement.actInv(state.a()[joint_id])

    def classical(spatial, of_velocity):
        return spatial[:3] + np.cross(of_velocity[3:].T, v.linear).T + np.cross(v.angular, of_velocity[:3].T).T

    c_dq, c_dv, c_da = classical(a_dq, v_dq), classical(a_dv, a_da), a_da[:3]
    (v_out,) = _linear_part(state, joint_id, placement, reference_frame, v.linear, [v_dq[:3]])
    acceleration = a.linear + np.cross(v.angular, v.linear)
    return (v_out, *_linear_part(state, joint_id, placement, reference_frame, acceleration, [c_dq, c_dv, c_da]))


def getCenterOfMassVelocityDerivatives(model: Model, data: Data) -> Array:
    """Returns the derivative (3, nv) of the velocity of the centre of mass by q, at the state of the last centerOfMass(q, v) or computeAllTerms."""
    c, d = prepare(model, data, "getCenterOfMassVelocityDerivatives")
    state = data.source("vcom", "getCenterOfMassVelocityDerivatives", "centerOfMass(model, data, q, v)")
    momentum = dyn.compute_centroidal_dynamics_derivatives(c.model, d, state.q, state.v_or_zero, np.zeros(c.nv)).dhg_dq
    return c.v_out(momentum[:3]) / c.model.mass
