# SPDX-License-Identifier: BSD-2-Clause
"""The motion of a single joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import libdyn as dyn

from .spatial import SE3, Motion, own

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .joints import JointModel


class JointData:
    """The motion of one joint: M (pose), S (6, nv), v and c (Motion), joint_q, joint_v."""

    def __init__(self, model: JointModel) -> None:
        self._joint = model
        robot = dyn.Model()
        parent = 0
        for k, (kind, parameters, placement) in enumerate(model.parts()):
            where = dyn.SE3() if placement is None else placement
            joint = dyn.JointDescription(f"joint{k}", kind, parameters, where)
            parent = robot.add_body(f"body{k}", parent, joint, dyn.Inertia(1.0, np.zeros(3), np.eye(3)))
        self._model = dyn.compile(robot)
        self._data = dyn.Data(self._model)
        self.calc(dyn.neutral(self._model), None, 0)

    def calc(self, q: ArrayLike, v: ArrayLike, first: Any = None) -> None:
        """Computes the motion at q and v, which are those of the whole model unless first = 0."""
        start_q, start_v = (max(self._joint.idx_q, 0), max(self._joint.idx_v, 0)) if first is None else (first, first)
        self.joint_q = q[start_q : start_q + self._model.nq].copy()
        self.joint_v = np.zeros(self._model.nv) if v is None else v[start_v : start_v + self._model.nv].copy()
        last = self._model.njoints - 1
        if last == 0:  # the universe
            self.M, self.v, self.c, self.S = SE3.Identity(), Motion.Zero(), Motion.Zero(), np.zeros((6, 0))
            return
        dyn.forward_kinematics(self._model, self._data, self.joint_q, self.joint_v, np.zeros(self._model.nv))
        self.M = own(dyn.joint_placement(self._model, self._data, last))
        self.v = own(dyn.joint_velocity(self._model, self._data, last))
        self.c = own(dyn.joint_acceleration(self._model, self._data, last))
        self.S = dyn.compute_joint_jacobian(self._model, self._data, self.joint_q, last)

    def shortname(self) -> str:
        """Returns the name of the type, such as "JointDataRX"."""
        return self._joint.shortname().replace("Model", "Data")

    def extract(self) -> Any:
        """Returns the data of its own type."""
        return self

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, JointData) or self.shortname() != other.shortname():
            return False
        return np.array_equal(self.joint_q, other.joint_q) and np.array_equal(self.joint_v, other.joint_v)

    def __getstate__(self) -> Any:
        return {"joint": self._joint, "q": self.joint_q, "v": self.joint_v}

    def __setstate__(self, state: Any) -> None:
        self.__init__(state["joint"])
        self.calc(state["q"], state["v"], 0)

    __hash__ = None
