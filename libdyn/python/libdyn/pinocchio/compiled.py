# SPDX-License-Identifier: BSD-2-Clause
"""libdyn's compiled model of a Model, and the way from one numbering to the other."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn as dyn

from . import convert

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from ._types import Array
    from .model import Model
    from .spatial import Force


class Compiled:
    """A compiled model. libdyn numbers joints depth first, Pinocchio in the order of addJoint; composite joints are several joints for libdyn.

    Attributes: model (libdyn's), gravity; for each joint last (libdyn's number of its last part), bodies (the name of its body), parents, joints,
    inertias, masses, centres (of mass, in the joint's frame), subtree_masses.
    """

    def __init__(self, model: Model) -> None:
        self.description, names = describe(model)
        self.model = dyn.compile(self.description, dissipation=False)
        self.bodies = [parts[-1] for parts in names]
        self.nq, self.nv, self.njoints = model.nq, model.nv, model.njoints
        joints = self.model.joints
        self.last = [self.model.joint_id(parts[-1]) for parts in names]
        self.parents, self.joints = model.parents.items(), model.joints.items()
        self.follows = bool(model.mimicking_joints)
        self.gravity = np.array(self.description.gravity)
        self.inertias = [Y.copy() for Y in model.inertias.items()]
        self.masses = np.array([0.0, *(Y.mass for Y in self.inertias[1:])])
        self.centres = np.array([np.zeros(3), *(Y.com for Y in self.inertias[1:])])
        self.subtree_masses = self.masses.copy()
        for i in range(self.njoints - 1, 0, -1):
            self.subtree_masses[self.parents[i]] += self.subtree_masses[i]
        q_order, v_order = np.zeros(model.nq, dtype=int), np.zeros(model.nv, dtype=int)
        for i in range(1, model.njoints):
            at_q, at_v = model.idx_qs[i], model.idx_vs[i]
            for name in names[i]:
                joint = joints[self.model.joint_id(name)]
                q_order[joint.idx_q : joint.idx_q + joint.nq] = range(at_q, at_q + joint.nq)
                v_order[joint.idx_v : joint.idx_v + joint.nv] = range(at_v, at_v + joint.nv)
                at_q, at_v = at_q + joint.nq, at_v + joint.nv
        self._quaternions = [model.idx_qs[i] + at for i, joint in enumerate(self.joints) for at in joint.quaternions()]
        self._q, self._q_back = _orders(q_order)
        self._v, self._v_back = _orders(v_order)
        self._joints_in_order = self.last == list(range(self.njoints))

    def q_in(self, q: ArrayLike, function: str, name: str = "q") -> Array:
        """Returns a configuration in libdyn's order. A zero quaternion is no rotation, as in Pinocchio. Raises ValueError for a wrong size."""
        q = convert.vector(q, self.nq, function, name)
        for at in self._quaternions:
            if q[at + 3] == 0.0 and not q[at : at + 4].any():
                q = q.copy()
                q[at + 3] = 1.0
        return q if self._q is None else q[self._q]

    def v_in(self, v: ArrayLike, function: str, name: str = "v") -> Array:
        """Returns a velocity, acceleration or force in libdyn's order. Raises ValueError for a wrong size."""
        v = convert.vector(v, self.nv, function, name)
        return v if self._v is None else v[self._v]

    def q_out(self, q: ArrayLike) -> Array:
        """Returns a configuration in Pinocchio's order."""
        return q if self._q is None else q[self._q_back]

    def v_out(self, v: ArrayLike) -> Array:
        """Returns vectors, or matrices with one column for each degree of freedom, in Pinocchio's order."""
        return v if self._v is None else v[..., self._v_back]

    def square_out(self, M: Any) -> Array:
        """Returns a matrix (nv, nv) in Pinocchio's order."""
        return M if self._v is None else M[np.ix_(self._v_back, self._v_back)]

    def rows_of_q(self, x: Any) -> Array:
        """Returns a matrix with one row for each coordinate in libdyn's order."""
        return x if self._q is None else x[self._q]

    def rows_in(self, x: Any) -> Array:
        """Returns a matrix with one row for each degree of freedom in libdyn's order."""
        return x if self._v is None else x[self._v]

    def rows_out(self, x: Any) -> Array:
        """Returns a matrix with one row for each degree of freedom in Pinocchio's order."""
        return x if self._v is None else x[self._v_back]

    def forces_in(self, fext: Sequence[Force], function: str) -> Array:
        """Returns forces on joints as libdyn's rows; None stays None. Raises ValueError for a wrong number."""
        if fext is None:
            return None
        if len(fext) != self.njoints:
            raise ValueError(f"{function}: fext has {len(fext)} forces, the model wants {self.njoints}, the universe's first")
        rows = np.array([f.vector for f in fext])
        if self._joints_in_order:
            return rows
        out = np.zeros((self.model.njoints, 6))
        out[self.last] = rows
        return out

    def blocks_out(self, x: Any, size: int) -> Array:
        """Returns a matrix with `size` columns for each joint but the universe, in Pinocchio's order."""
        if self._joints_in_order:
            return x
        return np.concatenate([x[..., size * (k - 1) : size * k] for k in self.last[1:]], axis=-1)


def _orders(order):
    """Returns the order and its inverse; None twice if nothing moves."""
    if np.array_equal(order, np.arange(len(order))):
        return None, None
    return order, np.argsort(order)


def describe(model: Model) -> Any:
    """Returns libdyn's description of a Model, and for each joint the names of its parts there."""
    robot = dyn.Model()
    robot.name = model.name
    gravity, armature = model.physics()
    if np.any(np.asarray(gravity.angular)):
        raise NotImplementedError("Model.gravity has an angular part; libdyn's gravity is a linear acceleration")
    robot.gravity = [float(x) for x in gravity.linear]
    joints, parents, placements, inertias = (x.items() for x in (model.joints, model.parents, model.jointPlacements, model.inertias))
    names = [["universe"]]
    for i in range(1, model.njoints):
        joint, name = joints[i], model.names[i]
        parts = joint.parts()
        at = joint.idx_v
        names.append([])
        for k, (kind, parameters, offset) in enumerate(parts):
            last = k == len(parts) - 1
            own = name if last else f"{name} part {k + 1}"
            placement = placements[i] if k == 0 else dyn.SE3()
            if offset is not None:
                placement = placement * offset
            described = dyn.JointDescription(own, kind, parameters, placement)
            if joint.nv:
                width = _WIDTHS[kind]
                described.armature = [float(x) for x in armature[at : at + width]]
                at += width
            if not joint.nv:
                described.couple(names[joint.followed][-1], "mimic", {"coefficients": [joint.offset, joint.scaling]})
            parent = names[-1][-1] if k else names[parents[i]][-1]
            robot.add_body(own, parent, described, inertias[i] if last else dyn.Inertia())
            names[-1].append(own)
    return robot, names


_WIDTHS = {"revolute": 1, "continuous": 1, "prismatic": 1, "helical": 1, "universal": 2, "spherical": 3, "spherical_zyx": 3, "translation": 3,
           "planar": 3, "free_flyer": 6}  # fmt: skip
