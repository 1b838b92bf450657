# SPDX-License-Identifier: BSD-2-Clause
"""The state at which an algorithm ran, and the quantities of that state that a program may read later from Data."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn as dyn

from .bodies import Bodies
from .elements import Elements
from .inertia import Inertia
from .spatial import SE3, Force, Motion, own

if TYPE_CHECKING:
    from .. import ReferenceFrame
    from ._types import Array
    from .compiled import Compiled


class Workspace:
    """libdyn's data for kinematics of one Data, and the state that it holds."""

    def __init__(self, compiled: Compiled) -> None:
        self.data, self.owner, self.derivatives = dyn.Data(compiled.model), None, None


class State:
    """q, v, a and forces of one call, in libdyn's order. Each method returns the field of Data with its name."""

    def __init__(
        self,
        compiled: Compiled,
        workspace: Workspace,
        q: Array,
        v: Optional[Array] = None,
        a: Optional[Array] = None,
        fext: Any = None,
    ) -> None:
        self.c, self._workspace = compiled, workspace
        self.q = q.copy()
        self.v_ = None if v is None else v.copy()
        self.a_ = None if a is None else a.copy()
        self.fext = fext
        self._bodies = None

    def moved(self, workspace: Workspace) -> State:
        """Returns the same state for another Data."""
        other = copy.copy(self)
        other._workspace, other._bodies = workspace, None
        return other

    @property
    def v_or_zero(self) -> Array:
        return np.zeros(self.c.nv) if self.v_ is None else self.v_

    @property
    def a_or_zero(self) -> Array:
        return np.zeros(self.c.nv) if self.a_ is None else self.a_

    def kinematics(self) -> Any:
        """Returns libdyn's data with poses, velocities and accelerations of this state."""
        w = self._workspace
        if w.owner is not self:
            dyn.forward_kinematics(self.c.model, w.data, self.q, self.v_or_zero, self.a_or_zero)
            w.owner, w.derivatives = self, None
        return w.data

    def derivatives(self) -> Any:
        """Returns libdyn's data that is ready for derivatives of the kinematics of this state."""
        w = self._workspace
        if w.derivatives is not self:
            dyn.compute_forward_kinematics_derivatives(self.c.model, w.data, self.q, self.v_or_zero, self.a_or_zero)
            w.owner = w.derivatives = self
        return w.data

    def _each(self, make):
        return Elements(self.c.njoints, make)

    def _moving(self, function, reference):
        last, model = self.c.last, self.c.model
        return self._each(lambda k: own(function(model, self.kinematics(), last[k], reference)) if k else Motion.Zero())

    def joints(self) -> Any:
        q, v = self.c.q_out(self.q), self.c.v_out(self.v_or_zero)

        def make(k):
            data = self.c.joints[k].createData()
            if k:
                data.calc(q, v)
            return data

        return self._each(make)

    def oMi(self) -> Elements:
        return self._each(self.joint_pose)

    def joint_pose(self, k: int) -> SE3:
        """Returns the pose of joint k in the world."""
        return own(dyn.joint_placement(self.c.model, self.kinematics(), self.c.last[k])) if k else SE3.Identity()

    def liMi(self) -> Elements:
        return self._each(lambda k: self.joint_pose(self.c.parents[k]).actInv(self.joint_pose(k)) if k else SE3.Identity())

    def v(self) -> Elements:
        return self._moving(dyn.joint_velocity, dyn.LOCAL)

    def ov(self) -> Any:
        return self._moving(dyn.joint_velocity, dyn.WORLD)

    def a(self) -> Elements:
        return self._moving(dyn.joint_acceleration, dyn.LOCAL)

    def oa(self) -> Any:
        return self._moving(dyn.joint_acceleration, dyn.WORLD)

    def a_gf(self) -> Elements:
        return self._each(lambda k: Motion(self.bodies().falling[k]))

    def oa_gf(self) -> Any:
        oa, gravity = self.oa(), Motion(self.c.gravity, np.zeros(3))
        return self._each(lambda k: oa[k] - gravity)

    def h(self) -> Elements:
        return self._each(lambda k: Force(self.bodies().momenta[k]))

    def oh(self) -> Any:
        return self._each(lambda k: self.joint_pose(k).act(Force(self.bodies().momenta[k])))

    def f(self) -> Elements:
        return self._each(lambda k: Force(self.bodies().forces[k]))

    def of(self) -> Any:
        return self._each(lambda k: self.joint_pose(k).act(Force(self.bodies().forces[k])))

    def J(self) -> Array:
        return self.c.v_out(dyn.compute_joint_jacobians(self.c.model, self._workspace_for_dynamics(), self.q))

    def dJ(self) -> Array:
        out = np.zeros((6, self.c.nv))
        data = self._workspace_for_dynamics()
        for k, joint in enumerate(self.c.model.joints):
            if joint.nv:
                rate = dyn.compute_joint_jacobian_time_variation(self.c.model, data, self.q, self.v_or_zero, k, dyn.WORLD)
                columns = slice(joint.idx_v, joint.idx_v + joint.nv)
                out[:, columns] = rate[:, columns]
        return self.c.v_out(out)

    def _workspace_for_dynamics(self):
        """Returns libdyn's data; what it holds of the kinematics is lost."""
        self._workspace.owner = self._workspace.derivatives = None
        return self._workspace.data

    def joint_jacobian(self, k: int, reference: ReferenceFrame) -> Array:
        """Returns the Jacobian (6, nv) of joint k."""
        if k == 0:
            return np.zeros((6, self.c.nv))
        return self.c.v_out(dyn.compute_joint_jacobian(self.c.model, self._workspace_for_dynamics(), self.q, self.c.last[k], reference))

    def jacobian_at(self, k: int, placement: SE3, reference: ReferenceFrame) -> Array:
        """Returns the Jacobian (6, nv) of the frame at `placement` in the frame of joint k."""
        if k == 0:
            return np.zeros((6, self.c.nv))
        return self.c.v_out(dyn.compute_jacobian_at(self.c.model, self._workspace_for_dynamics(), self.q, self.c.last[k], placement, reference))

    def joint_jacobian_rate(self, k: int, reference: ReferenceFrame) -> Array:
        """Returns the rate (6, nv) of the Jacobian of joint k."""
        if k == 0:
            return np.zeros((6, self.c.nv))
        data = self._workspace_for_dynamics()
        return self.c.v_out(dyn.compute_joint_jacobian_time_variation(self.c.model, data, self.q, self.v_or_zero, self.c.last[k], reference))

    def bodies(self) -> Bodies:
        """Returns the Bodies of this state."""
        if self._bodies is None:
            self._bodies = Bodies(self)
        return self._bodies

    def centre_of_mass(self) -> Any:
        """Returns libdyn's centre of mass: position, velocity, acceleration."""
        return dyn.center_of_mass(self.c.model, self._workspace_for_dynamics(), self.q, self.v_or_zero, self.a_or_zero)

    def mass(self) -> Any:
        return self._each(lambda k: float(self.c.subtree_masses[k]))

    def com(self) -> Elements:
        return self._each(lambda k: self.bodies().centre(k) if k else self.centre_of_mass().position)

    def com_in_world(self) -> Any:
        return self._each(lambda k: self.bodies().centres[k].copy() if k else self.centre_of_mass().position)

    def vcom(self) -> Elements:
        return self._each(lambda k: self.bodies().centre_velocity(k) if k else self.centre_of_mass().velocity)

    def acom(self) -> Elements:
        return self._each(lambda k: self.bodies().centre_acceleration(k) if k else self.centre_of_mass().acceleration)

    def oYcrb(self) -> Any:
        return self._each(lambda k: self.bodies().composite(k))

    def Ycrb(self) -> Any:
        return self._each(lambda k: self.joint_pose(k).actInv(self.bodies().composite(k)))

    def Ig(self) -> Inertia:
        total = self.bodies().composite(0)
        return Inertia(total.mass, np.zeros(3), total.rotational)
