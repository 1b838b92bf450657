# SPDX-License-Identifier: BSD-2-Clause
"""Quantities of all bodies at one state: forces that joints transmit, and the centres of mass and inertias of subtrees."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn as dyn

from .spatial import own

if TYPE_CHECKING:
    from ._types import Array
    from .state import State


class Bodies:
    """The motion of each joint: poses (in the world), velocities and accelerations (in joint axes), as libdyn's own objects. Joint 0 rests."""

    def __init__(self, state: State) -> None:
        self.c, self.fext = state.c, state.fext
        model, data, last = self.c.model, state.kinematics(), self.c.last[1:]
        self.poses = [dyn.SE3(), *(dyn.joint_placement(model, data, k) for k in last)]
        self.velocities = [dyn.Motion(), *(dyn.joint_velocity(model, data, k, dyn.LOCAL) for k in last)]
        self.accelerations = [dyn.Motion(), *(dyn.joint_acceleration(model, data, k, dyn.LOCAL) for k in last)]

    @functools.cached_property
    def falling(self) -> list[Any]:
        """The accelerations minus gravity."""
        up = dyn.Motion(-self.c.gravity, np.zeros(3))
        return [a + M.act_inverse(up) for a, M in zip(self.accelerations, self.poses)]

    @functools.cached_property
    def momenta(self) -> list[Any]:
        """The momentum of each body, in joint axes."""
        return [dyn.Force(), *(dyn.Inertia.__matmul__(Y, v) for Y, v in zip(self.c.inertias[1:], self.velocities[1:]))]

    @functools.cached_property
    def forces(self) -> list[Any]:
        """The forces that joints transmit to their bodies, in joint axes."""
        c, fall, h = self.c, self.falling, self.momenta
        out = [dyn.Force(), *(dyn.Inertia.__matmul__(c.inertias[k], fall[k]) + self.velocities[k].cross(h[k]) for k in range(1, c.njoints))]
        if self.fext is not None:
            out = [f - dyn.Force(self.fext[k]) for f, k in zip(out, c.last)]
        for k in range(c.njoints - 1, 0, -1):
            out[c.parents[k]] += (self.poses[c.parents[k]].inverse() * self.poses[k]).act(out[k])
        return out

    def _means(self, vectors):
        """Returns the means, weighted by mass, of world vectors (n, 3) over the subtree of each joint; NaN where there is no mass."""
        sums = self.c.masses[:, None] * vectors
        for k in range(self.c.njoints - 1, 0, -1):
            sums[self.c.parents[k]] += sums[k]
        total = self.c.subtree_masses
        return sums / np.where(total > 0, total, np.nan)[:, None]

    @functools.cached_property
    def _turns(self):
        return np.array([M.R for M in self.poses])

    def _in_world(self, vectors):
        return np.einsum("kij,kj->ki", self._turns, vectors)

    @functools.cached_property
    def centres(self) -> Array:
        """The centre of mass of each joint's subtree, in the world (n, 3)."""
        return self._means(np.array([M.p for M in self.poses]) + self._in_world(self.c.centres))

    @functools.cached_property
    def _twists(self):
        return np.array([v.vector for v in self.velocities])

    def _point_velocities(self):
        return self._twists[:, :3] + np.cross(self._twists[:, 3:], self.c.centres)

    @functools.cached_property
    def _centre_velocities(self):
        return self._means(self._in_world(self._point_velocities()))

    @functools.cached_property
    def _centre_accelerations(self):
        rates = np.array([a.vector for a in self.accelerations])
        spatial = rates[:, :3] + np.cross(rates[:, 3:], self.c.centres)
        return self._means(self._in_world(spatial + np.cross(self._twists[:, 3:], self._point_velocities())))

    def centre(self, k: int) -> Array:
        """Returns the centre of mass of the subtree of joint k, in the joint's frame."""
        return self.poses[k].R.T @ (self.centres[k] - self.poses[k].p)

    def centre_velocity(self, k: int) -> Any:
        """Returns the velocity of the same point, in the joint's axes."""
        return self.poses[k].R.T @ self._centre_velocities[k]

    def centre_acceleration(self, k: int) -> Any:
        """Returns the acceleration of the same point, in the joint's axes."""
        return self.poses[k].R.T @ self._centre_accelerations[k]

    @functools.cached_property
    def _composites(self):
        out = [dyn.Inertia(), *(M.act(Y) for M, Y in zip(self.poses[1:], self.c.inertias[1:]))]
        for k in range(self.c.njoints - 1, 0, -1):
            out[self.c.parents[k]] = out[self.c.parents[k]] + out[k]
        return out

    def composite(self, k: int) -> Any:
        """Returns the inertia of the subtree of joint k, in the world."""
        return own(self._composites[k])
