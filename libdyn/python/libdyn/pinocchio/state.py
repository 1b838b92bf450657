# SPDX-License-Identifier: BSD-2-Clause
"""The state at which an algorithm ran, and the quantities of that state that a program may read later from Data."""
import copy

import numpy as np

import libdyn as dyn

from .elements import Elements
from .inertia import Inertia
from .spatial import SE3, Force, Motion, own


class Workspace:
    """libdyn's data for kinematics of one Data, and the state that it holds."""

    def __init__(self, compiled):
        self.data, self.owner, self.derivatives = dyn.Data(compiled.model), None, None


class State:
    """q, v, a and forces of one call, in libdyn's order. Each method returns the field of Data with its name."""

    def __init__(self, compiled, workspace, q, v=None, a=None, fext=None):
        self.c, self._workspace = compiled, workspace
        self.q = q.copy()
        self.v_ = None if v is None else v.copy()
        self.a_ = None if a is None else a.copy()
        self.fext = fext
        self._cache = {}

    def moved(self, workspace):
        """Returns the same state for another Data."""
        other = copy.copy(self)
        other._workspace, other._cache = workspace, {}
        return other

    @property
    def v_or_zero(self):
        return np.zeros(self.c.nv) if self.v_ is None else self.v_

    @property
    def a_or_zero(self):
        return np.zeros(self.c.nv) if self.a_ is None else self.a_

    def kinematics(self):
        """Returns libdyn's data with poses, velocities and accelerations of this state."""
        w = self._workspace
        if w.owner is not self:
            dyn.forward_kinematics(self.c.model, w.data, self.q, self.v_or_zero, self.a_or_zero)
            w.owner, w.derivatives = self, None
        return w.data

    def derivatives(self):
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

    def oMi(self):
        return self._each(self.joint_pose)

    def joint_pose(self, k):
        """Returns the pose of joint k in the world."""
        return own(dyn.joint_placement(self.c.model, self.kinematics(), self.c.last[k])) if k else SE3.Identity()

    def liMi(self):
        return self._each(lambda k: self.joint_pose(self.c.parents[k]).actInv(self.joint_pose(k)) if k else SE3.Identity())

    def v(self):
        return self._moving(dyn.joint_velocity, dyn.LOCAL)

    def ov(self):
        return self._moving(dyn.joint_velocity, dyn.WORLD)

    def a(self):
        return self._moving(dyn.joint_acceleration, dyn.LOCAL)

    def oa(self):
        return self._moving(dyn.joint_acceleration, dyn.WORLD)

    def a_gf(self):
        a = self.arrays()
        return self._each(lambda k: Motion(a.A_gf[k]))

    def oa_gf(self):
        oa, gravity = self.oa(), Motion(self.c.gravity, np.zeros(3))
        return self._each(lambda k: oa[k] - gravity)

    def h(self):
        a = self.arrays()
        return self._each(lambda k: Force(a.momenta[k]))

    def oh(self):
        h = self.h()
        return self._each(lambda k: self.joint_pose(k).act(h[k]))

    def f(self):
        a = self.arrays()
        return self._each(lambda k: Force(a.joint_forces()[k]))

    def of(self):
        f = self.f()
        return self._each(lambda k: self.joint_pose(k).act(f[k]))

    def J(self):
        return self.c.v_out(dyn.compute_joint_jacobians(self.c.model, self._workspace_for_dynamics(), self.q))

    def dJ(self):
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

    def joint_jacobian(self, k, reference):
        """Returns the Jacobian (6, nv) of joint k."""
        if k == 0:
            return np.zeros((6, self.c.nv))
        return self.c.v_out(dyn.compute_joint_jacobian(self.c.model, self._workspace_for_dynamics(), self.q, self.c.last[k], reference))

    def joint_jacobian_rate(self, k, reference):
        """Returns the rate (6, nv) of the Jacobian of joint k."""
        if k == 0:
            return np.zeros((6, self.c.nv))
        data = self._workspace_for_dynamics()
        return self.c.v_out(dyn.compute_joint_jacobian_time_variation(self.c.model, data, self.q, self.v_or_zero, self.c.last[k], reference))

    def arrays(self):
        """Returns the Bodies of this state."""
        if "arrays" not in self._cache:
            self._cache["arrays"] = Bodies(self)
        return self._cache["arrays"]

    def mass(self):
        return self._each(lambda k: float(self.arrays().subtree_masses[k]))

    def com(self):
        return self._each(lambda k: self.arrays().in_joint(self.arrays().centres, k, True))

    def com_in_world(self):
        return self._each(lambda k: self.arrays().centres[k].copy())

    def vcom(self):
        return self._each(lambda k: self.arrays().in_joint(self.arrays().centre_velocities, k))

    def acom(self):
        return self._each(lambda k: self.arrays().in_joint(self.arrays().centre_accelerations, k))

    def oYcrb(self):
        a = self.arrays()
        return self._each(lambda k: a.composite(k) if k else Inertia.Zero())

    def Ycrb(self):
        a = self.arrays()
        return self._each(lambda k: self.joint_pose(k).actInv(a.composite(k)) if k else Inertia.Zero())

    def Ig(self):
        a = self.arrays()
        total = a.composite(0)
        return Inertia(total.mass, np.zeros(3), np.asarray(total.inertia))


class Bodies:
    """Arrays with one row for each joint: R (n, 3, 3) and p (n, 3) of the poses in the world, V and A (n, 6) in joint axes."""

    def __init__(self, state):
        c, data = state.c, state.kinematics()
        self.c, n = c, c.njoints
        self.fext = state.fext
        self.R, self.p, self.V, self.A = np.tile(np.eye(3), (n, 1, 1)), np.zeros((n, 3)), np.zeros((n, 6)), np.zeros((n, 6))
        for k in range(1, n):
            pose = dyn.joint_placement(c.model, data, c.last[k])
            self.R[k], self.p[k] = pose.R, pose.p
            self.V[k] = dyn.joint_velocity(c.model, data, c.last[k], dyn.LOCAL).vector
            self.A[k] = dyn.joint_acceleration(c.model, data, c.last[k], dyn.LOCAL).vector
        self.masses = np.array([0.0, *(Y.mass for Y in c.inertias[1:])])
        self.levers = np.array([np.zeros(3), *(np.asarray(Y.lever) for Y in c.inertias[1:])])
        self.rotational = np.array([np.zeros((3, 3)), *(np.asarray(Y.inertia) for Y in c.inertias[1:])])
        self.A_gf = self.A.copy()
        self.A_gf[:, :3] -= np.einsum("kji,j->ki", self.R, c.gravity)

    def _subtree_sums(self, x):
        """Returns the sums of the rows of x over each joint's subtree."""
        out = np.array(x, dtype=float)
        for k in range(self.c.njoints - 1, 0, -1):
            out[self.c.parents[k]] += out[k]
        return out

    def _times_inertia(self, X):
        """Returns the rows of I_k X_k."""
        linear = self.masses[:, None] * (X[:, :3] + np.cross(X[:, 3:], self.levers))
        return np.hstack([linear, np.einsum("kij,kj->ki", self.rotational, X[:, 3:]) + np.cross(self.levers, linear)])

    @property
    def momenta(self):
        return self._times_inertia(self.V)

    def joint_forces(self):
        """Returns the forces (n, 6) that joints transmit to their bodies, in joint axes."""
        h, v, w = self.momenta, self.V[:, :3], self.V[:, 3:]
        f = self._times_inertia(self.A_gf)
        f += np.hstack([np.cross(w, h[:, :3]), np.cross(w, h[:, 3:]) + np.cross(v, h[:, :3])])
        if self.fext is not None:
            f -= self.fext[self.c.last]
        for k in range(self.c.njoints - 1, 0, -1):
            parent = self.c.parents[k]
            R = self.R[parent].T @ self.R[k]
            p = self.R[parent].T @ (self.p[k] - self.p[parent])
            linear = R @ f[k, :3]
            f[parent] += np.concatenate([linear, R @ f[k, 3:] + np.cross(p, linear)])
        return f

    @property
    def subtree_masses(self):
        return self._subtree_sums(self.masses)

    def _means(self, x):
        """Returns the means, weighted by mass, of world vectors x over each joint's subtree."""
        total = self.subtree_masses
        return self._subtree_sums(self.masses[:, None] * x) / np.where(total > 0, total, np.nan)[:, None]

    def _in_world(self, x):
        return np.einsum("kij,kj->ki", self.R, x)

    @property
    def centres(self):
        return self._means(self.p + self._in_world(self.levers))

    def _point_velocities(self):
        return self.V[:, :3] + np.cross(self.V[:, 3:], self.levers)

    @property
    def centre_velocities(self):
        return self._means(self._in_world(self._point_velocities()))

    @property
    def centre_accelerations(self):
        spatial = self.A[:, :3] + np.cross(self.A[:, 3:], self.levers)
        return self._means(self._in_world(spatial + np.cross(self.V[:, 3:], self._point_velocities())))

    def in_joint(self, x, k, point=False):
        """Returns row k in axes of joint k, and about its origin if it is a point; row 0 stays in the world."""
        return x[k].copy() if k == 0 else self.R[k].T @ (x[k] - self.p[k] if point else x[k])

    def composite(self, k):
        """Returns the inertia of the subtree of joint k, in the world."""
        total = Inertia.Zero()
        for i in range(max(k, 1), self.c.njoints):
            j = i
            while j > k:
                j = self.c.parents[j]
            if j == k:
                total = total + SE3(self.R[i], self.p[i]).act(self.c.inertias[i])
        return total
