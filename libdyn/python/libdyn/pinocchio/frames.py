# SPDX-License-Identifier: BSD-2-Clause
"""Frames of a model."""

from __future__ import annotations

import copy
from typing import Any

from .enums import FrameType
from .inertia import Inertia
from .spatial import SE3


class Frame:
    """A named frame that is fixed to a joint.

    Arguments: name, parentJoint, [parentFrame,] placement, type, [inertia]; or another frame, to copy it. `placement` is the pose in the joint's
    frame. `parentFrame` is the index of the frame before it, which has no influence on results.
    """

    def __init__(self, name: Any = "", *rest: Any, **named: Any) -> None:
        if isinstance(name, Frame) or "other" in named:
            self.__dict__.update(copy.deepcopy((named.get("other") or name).__dict__))
            return
        keys = ["parentJoint", "parentFrame", "placement", "type", "inertia"]
        if "parent_frame" not in named and (len(rest) < 2 or isinstance(rest[1], SE3)):
            keys.remove("parentFrame")
        given = dict(zip(keys, rest), **{{"parent_joint": "parentJoint", "parent_frame": "parentFrame"}.get(k, k): x for k, x in named.items()})
        self.name = name
        self.parentJoint = int(given.get("parentJoint", 0))
        self.parentFrame = int(given.get("parentFrame", 0))
        placement, inertia = given.get("placement"), given.get("inertia")
        self.placement = SE3.Identity() if placement is None else placement.copy()
        self.type = FrameType(given.get("type", FrameType.OP_FRAME))
        self.inertia = Inertia.Zero() if inertia is None else inertia.copy()

    @property
    def parent(self) -> int:
        """The same as parentJoint."""
        return self.parentJoint

    @parent.setter
    def parent(self, value: int) -> None:
        self.parentJoint = value

    @property
    def previousFrame(self) -> int:
        """The same as parentFrame."""
        return self.parentFrame

    @previousFrame.setter
    def previousFrame(self, value: int) -> None:
        self.parentFrame = value

    def copy(self) -> Frame:
        """Returns a copy."""
        return copy.deepcopy(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Frame):
            return NotImplemented
        return (
            (self.name, self.parentJoint, self.parentFrame, self.type) == (other.name, other.parentJoint, other.parentFrame, other.type)
            and self.placement == other.placement
            and self.inertia == other.inertia
        )

    def __repr__(self) -> str:
        return f"Frame name: {self.name} parent joint: {self.parentJoint} parent frame: {self.parentFrame} type: {self.type.name}\n{self.placement}"

    __hash__ = None
