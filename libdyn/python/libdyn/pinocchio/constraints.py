# SPDX-License-Identifier: BSD-2-Clause
"""Rigid contacts and closed loops, and the dynamics under them. libdyn's solver needs no proximal iterations, so their settings have no influence."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn as dyn

from .calls import prepare
from .contact import impulseDynamicsWithJacobian
from .contact_cholesky import ContactCholeskyDecomposition
from .containers import instances, typed_list
from .convert import index
from .enums import LOCAL, LOCAL_WORLD_ALIGNED, WORLD, ContactType
from .kinematics import PLACEMENTS
from .spatial import SE3, Force, Motion

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from ._types import Array
    from .compiled import Compiled
    from .data import Data
    from .model import Model


class BaumgarteCorrectorParameters:
    """Gains of the feedback on violations: Kp on the position error [1/s^2], Kd on the velocity [1/s]; one number for each row."""

    def __init__(self, size: int) -> None:
        self.Kp, self.Kd = np.zeros(size), np.zeros(size)

    def gains(self) -> tuple[float, float]:
        """Returns both gains as numbers. Raises NotImplementedError if rows differ."""
        for name in ("Kp", "Kd"):
            if np.ptp(np.atleast_1d(getattr(self, name))) != 0:
                raise NotImplementedError(f"RigidConstraintModel: corrector.{name} differs between rows; libdyn has one gain for a constraint")
        return float(np.atleast_1d(self.Kp)[0]), float(np.atleast_1d(self.Kd)[0])

    def __eq__(self, other: object) -> bool:
        return np.array_equal(self.Kp, other.Kp) and np.array_equal(self.Kd, other.Kd)

    __hash__ = None


class RigidConstraintModel:
    """A point or a frame of one joint that moves with one of another joint or of the world.

    Arguments: contact_type, model, joint1_id, [joint1_placement,] [joint2_id, [joint2_placement,]] [reference_frame]. Forces act on joint 1, in the
    axes of its constraint frame (LOCAL), or in world axes (LOCAL_WORLD_ALIGNED).
    """

    def __init__(self, contact_type: ContactType, model: Model, joint1_id: int, *rest: Any, **named: Any) -> None:
        keys = iter(("joint1_placement", "joint2_id", "joint2_placement", "reference_frame"))
        given = dict(named)
        for x in rest:
            wanted = SE3 if isinstance(x, SE3) else int if isinstance(x, (int, np.integer)) else type(LOCAL)
            kinds = {"joint1_placement": SE3, "joint2_placement": SE3, "joint2_id": int, "reference_frame": type(LOCAL)}
            key = next((k for k in keys if kinds[k] is wanted), None)
            if key is None:
                raise TypeError("RigidConstraintModel: give contact_type, model, joint1_id, placement, joint2_id, placement, reference_frame")
            given[key] = x
        self.type = ContactType(contact_type)
        if self.type == ContactType.CONTACT_UNDEFINED:
            raise ValueError("RigidConstraintModel: contact_type must be CONTACT_3D or CONTACT_6D")
        self.name = ""
        self.joint1_id = index(joint1_id, model.njoints, "RigidConstraintModel", "joint1_id")
        self.joint2_id = index(given.get("joint2_id", 0), model.njoints, "RigidConstraintModel", "joint2_id")
        self.joint1_placement = given.get("joint1_placement", SE3.Identity()).copy()
        self.joint2_placement = given.get("joint2_placement", SE3.Identity()).copy()
        self.reference_frame = given.get("reference_frame", LOCAL)
        if self.reference_frame not in (LOCAL, LOCAL_WORLD_ALIGNED):
            raise ValueError("RigidConstraintModel: reference_frame must be LOCAL or LOCAL_WORLD_ALIGNED")
        self.desired_contact_placement = SE3.Identity()
        self.desired_contact_velocity = Motion.Zero()
        self.desired_contact_acceleration = Motion.Zero()
        self.corrector = BaumgarteCorrectorParameters(self.size())

    def size(self) -> int:
        """Returns the number of rows, 3 or 6."""
        return 3 if self.type == ContactType.CONTACT_3D else 6

    def createData(self) -> RigidConstraintData:
        """Returns memory for results."""
        return RigidConstraintData(self)

    def copy(self) -> RigidConstraintModel:
        """Returns a copy."""
        return copy.deepcopy(self)

    def description(self, c: Compiled, k: int) -> Any:
        """Returns the constraint number k as libdyn describes it."""
        wanted = (self.desired_contact_placement, self.desired_contact_velocity, self.desired_contact_acceleration)
        if wanted != (SE3.Identity(), Motion.Zero(), Motion.Zero()):
            raise NotImplementedError("RigidConstraintModel: desired placements, velocities and accelerations other than zero are not in libdyn")
        gains = self.corrector.gains()
        free = [False] * 3 + [self.size() == 3] * 3
        frame, other = c.bodies[self.joint1_id], c.bodies[self.joint2_id]
        target = self.joint2_id != 0 or gains[0] != 0
        out = dyn.frame_constraint(
            f"constraint {k}", frame, other, self.joint1_placement, self.joint2_placement, free=free, target=target
        )
        out.baumgarte = gains
        return out

    def key(self) -> Any:
        """Returns what libdyn's description depends on."""
        parts = (self.joint1_placement, self.joint2_placement, self.desired_contact_placement)
        poses = tuple(x.tobytes() for M in parts for x in (M.R, M.p))
        return (self.type, self.joint1_id, self.joint2_id, self.reference_frame, poses, str(self.corrector.Kp), str(self.corrector.Kd))

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RigidConstraintModel) and self.key() == other.key() and self.name == other.name

    __hash__ = None


class RigidConstraintData:
    """Results of one constraint: contact_force on joint 1, oMc1, oMc2, c1Mc2."""

    def __init__(self, contact_model: RigidConstraintModel) -> None:
        self.contact_force = Force.Zero()
        self.oMc1, self.oMc2, self.c1Mc2 = SE3.Identity(), SE3.Identity(), SE3.Identity()

    def copy(self) -> RigidConstraintData:
        """Returns a copy."""
        return copy.deepcopy(self)

    def place(self, model: Model, oMi: Any) -> None:
        """Computes the poses of the constraint frames."""
        self.oMc1, self.oMc2 = oMi[model.joint1_id] * model.joint1_placement, oMi[model.joint2_id] * model.joint2_placement
        self.c1Mc2 = self.oMc1.actInv(self.oMc2)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RigidConstraintData) and self.__dict__ == other.__dict__

    __hash__ = None


class ProximalSettings:
    """Settings of Pinocchio's solver: absolute_accuracy, relative_accuracy, mu, max_iter. They have no influence on libdyn's."""

    def __init__(self, *numbers: Any) -> None:
        if len(numbers) not in (0, 3, 4):
            raise TypeError("ProximalSettings: give accuracy, mu, max_iter, or absolute_accuracy, relative_accuracy, mu, max_iter")
        absolute, *rest = numbers or (1e-12, 0.0, 1)
        relative = rest.pop(0) if len(rest) == 3 else 1e-12
        self.absolute_accuracy, self.relative_accuracy, self.mu, self.max_iter = float(absolute), float(relative), float(rest[0]), int(rest[1])
        self.iter, self.absolute_residual, self.relative_residual = 0, 0.0, 0.0


StdVec_RigidConstraintModel = typed_list("StdVec_RigidConstraintModel", instances(RigidConstraintModel), __name__)
StdVec_RigidConstraintData = typed_list("StdVec_RigidConstraintData", instances(RigidConstraintData), __name__)


def _problem(model, data, contact_models, function):
    """Returns the compiled model, libdyn's data, and libdyn's data of the constraints, which are made anew if the constraints have changed."""
    c, d = prepare(model, data, function)
    key = tuple(x.key() for x in contact_models)
    known = data.__dict__.get("_constraints")
    if known is None or known[0] is not c or known[1] != key:
        constraints = dyn.ConstraintSet(c.model, [x.description(c, k) for k, x in enumerate(contact_models)])
        known = data._constraints = (c, key, dyn.ConstraintData(constraints))
    return c, d, known[2]


def _place(data, contact_models, contact_datas, function):
    """Computes the poses of the constraint frames."""
    if len(contact_datas) != len(contact_models):
        raise ValueError(f"{function}: contact_datas has {len(contact_datas)} entries, contact_models has {len(contact_models)}")
    for contact, result in zip(contact_models, contact_datas):
        result.place(contact, data.oMi)


def _blocks(contact_models, contact_datas):
    """Returns for each three rows: their slice, the constraint, and the turn from its frame to its reference."""
    at = 0
    for contact, result in zip(contact_models, contact_datas):
        R = result.oMc1.rotation if contact.reference_frame == LOCAL_WORLD_ALIGNED else np.eye(3)
        for _ in range(contact.size() // 3):
            yield slice(at, at + 3), contact, R
            at += 3


def _turned(contact_models, contact_datas, rows):
    """Returns rows, which are in the axes of the constraint frames, in those of the references."""
    out = np.array(rows)
    for part, _, R in _blocks(contact_models, contact_datas):
        out[part] = R @ out[part]
    return out


def _store(data, contact_models, contact_datas, rows, function):
    """Writes the forces of all constraints, and the poses of their frames; returns the rows in the axes of the references."""
    _place(data, contact_models, contact_datas, function)
    rows, at = _turned(contact_models, contact_datas, rows), 0
    for contact, result in zip(contact_models, contact_datas):
        mine = rows[at : at + contact.size()]
        at += contact.size()
        result.contact_force = Force(mine[:3], mine[3:] if len(mine) == 6 else np.zeros(3))
    return rows


def _force_derivatives(data, contact_models, contact_datas, forces, by_q, *others):
    """Returns derivatives of forces in the axes of the references, from those in the axes of the frames. By q, the frames turn."""
    out = [_turned(contact_models, contact_datas, x) for x in (by_q, *others)]
    state = data.source("oMi", "derivatives of constraint forces", "constraintDynamics")
    for part, contact, _ in _blocks(contact_models, contact_datas):
        if contact.reference_frame == LOCAL_WORLD_ALIGNED:
            turning = state.joint_jacobian(contact.joint1_id, WORLD)[3:]
            out[0][part] += np.cross(turning.T, forces[part]).T
    return out


def initConstraintDynamics(model: Model, data: Data, contact_models: Sequence[RigidConstraintModel]) -> None:
    """Resolves the constraints once, so that the first constraintDynamics need not."""
    _problem(model, data, contact_models, "initConstraintDynamics")
    data.contact_chol = ContactCholeskyDecomposition(model, contact_models)


def constraintDynamics(
    model: Model,
    data: Data,
    q: ArrayLike,
    v: ArrayLike,
    tau: ArrayLike,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
    prox_settings: Optional[ProximalSettings] = None,
) -> Array:
    """Returns the accelerations (nv,) under tau and the constraints; also data.ddq, lambda_c, and contact_force of each contact data."""
    name = "constraintDynamics"
    c, d, constraints = _problem(model, data, contact_models, name)
    q, v, tau = c.q_in(q, name), c.v_in(v, name, "v"), c.v_in(tau, name, "tau")
    motion = dyn.constraint_dynamics(c.model, d, q, v, tau, constraints)
    data.note((*PLACEMENTS, "v"), data.state(q, v, motion.ddq))
    data._constrained = (q.copy(), v.copy(), tau.copy())
    data.ddq, data.lambda_c = c.v_out(motion.ddq), _store(data, contact_models, contact_datas, motion.forces, name)
    if prox_settings is not None:
        prox_settings.iter, prox_settings.absolute_residual = max(motion.iterations, 1), motion.residual
    return data.ddq


def computeConstraintDynamicsDerivatives(
    model: Model,
    data: Data,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
    settings: Optional[ProximalSettings] = None,
) -> tuple[Array, ...]:
    """Returns the derivatives of the last constraintDynamics: of ddq by q, v, tau (nv, nv), then of lambda_c (rows, nv); also in data."""
    name = "computeConstraintDynamicsDerivatives"
    c, d, constraints = _problem(model, data, contact_models, name)
    if data.__dict__.get("_constrained") is None:
        raise ValueError(f"{name}: call constraintDynamics first")
    of_motion_and_force = dyn.compute_constraint_dynamics_derivatives(c.model, d, *data._constrained, constraints)
    data.ddq_dq, data.ddq_dv, data.ddq_dtau = map(c.square_out, of_motion_and_force[:3])
    of_forces = map(c.v_out, of_motion_and_force[3:])
    turned = _force_derivatives(data, contact_models, contact_datas, data.lambda_c, *of_forces)
    data.dlambda_dq, data.dlambda_dv, data.dlambda_dtau = turned
    return data.ddq_dq, data.ddq_dv, data.ddq_dtau, data.dlambda_dq, data.dlambda_dv, data.dlambda_dtau


def impulseDynamics(model: Model, data: Data, *arguments: Any, **named: Any) -> Array:
    """Returns the velocities (nv,) after an impact; also data.dq_after, impulse_c.

    Arguments: q, v, contact_models, contact_datas, r_coeff=0, prox_settings; or as impulseDynamicsWithJacobian takes them.
    """
    third = arguments[2] if len(arguments) > 2 else None
    with_contacts = "contact_models" in named or isinstance(third, list) and all(isinstance(x, RigidConstraintModel) for x in third)
    return (_impact if with_contacts else impulseDynamicsWithJacobian)(model, data, *arguments, **named)


def _impact(model, data, q, v, contact_models, contact_datas, r_coeff=0.0, prox_settings=None):
    name = "impulseDynamics"
    c, d, constraints = _problem(model, data, contact_models, name)
    q, v = c.q_in(q, name), c.v_in(v, name, "v")
    impact = dyn.impulse_dynamics(c.model, d, q, v, float(r_coeff), constraints)
    data.note((*PLACEMENTS, "v"), data.state(q, v))
    data._impact = (q.copy(), v.copy())
    data.dq_after, data.impulse_c = c.v_out(impact.v_after), _store(data, contact_models, contact_datas, impact.impulses, name)
    return data.dq_after


def computeImpulseDynamicsDerivatives(
    model: Model,
    data: Data,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
    r_coeff: float = 0.0,
    prox_settings: Optional[ProximalSettings] = None,
) -> None:
    """Computes the derivatives of the last impulseDynamics: data.ddq_dq and ddq_dv of the velocities (nv, nv), dlambda_dq and dlambda_dv."""
    name = "computeImpulseDynamicsDerivatives"
    c, d, constraints = _problem(model, data, contact_models, name)
    if data.__dict__.get("_impact") is None:
        raise ValueError(f"{name}: call impulseDynamics with contact models first")
    of_motion_and_impulse = dyn.compute_impulse_dynamics_derivatives(c.model, d, *data._impact, float(r_coeff), constraints)
    data.ddq_dq, data.ddq_dv = map(c.square_out, of_motion_and_impulse[:2])
    of_impulses = map(c.v_out, of_motion_and_impulse[2:])
    data.dlambda_dq, data.dlambda_dv = _force_derivatives(data, contact_models, contact_datas, data.impulse_c, *of_impulses)


def getConstraintsJacobian(
    model: Model,
    data: Data,
    contact_models: Sequence[RigidConstraintModel],
    contact_datas: Sequence[RigidConstraintData],
) -> Array:
    """Returns the Jacobian (rows, nv) of constraints at the state of the last forwardKinematics or computeJointJacobians."""
    c, d = prepare(model, data, "getConstraintsJacobian")
    state = data.source("oMi", "getConstraintsJacobian", "computeJointJacobians(model, data, q)")
    constraints = dyn.ConstraintData(dyn.ConstraintSet(c.model, [x.description(c, k) for k, x in enumerate(contact_models)]))
    _place(data, contact_models, contact_datas, "getConstraintsJacobian")
    J = c.v_out(dyn.compute_constraint_jacobian(c.model, d, state.q, constraints))
    return _turned(contact_models, contact_datas, J)


def getConstraintJacobian(model: Model, data: Data, contact_model: RigidConstraintModel, contact_data: RigidConstraintData) -> Array:
    """Returns the Jacobian (rows, nv) of one constraint, as getConstraintsJacobian does for several."""
    return getConstraintsJacobian(model, data, [contact_model], [contact_data])
