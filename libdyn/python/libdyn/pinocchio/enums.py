# SPDX-License-Identifier: BSD-2-Clause
"""Enumerations with Pinocchio's names. Those that libdyn has itself are libdyn's own."""
import enum

from .. import ArgumentPosition, ReferenceFrame

LOCAL = ReferenceFrame.LOCAL
WORLD = ReferenceFrame.WORLD
LOCAL_WORLD_ALIGNED = ReferenceFrame.LOCAL_WORLD_ALIGNED
ARG0 = ArgumentPosition.ARG0
ARG1 = ArgumentPosition.ARG1


class KinematicLevel(enum.IntEnum):
    """How many derivatives of the motion a function is about."""

    POSITION = 0
    VELOCITY = 1
    ACCELERATION = 2


class Convention(enum.IntEnum):
    """The frames in which Pinocchio's recursions run. libdyn chooses them itself, so the choice has no influence on results."""

    WORLD = 0
    LOCAL = 1


class FrameType(enum.IntFlag):
    """What a frame stands for. Values combine by |."""

    OP_FRAME = 1
    JOINT = 2
    FIXED_JOINT = 4
    BODY = 8
    SENSOR = 16


class ContactType(enum.IntEnum):
    """Which relative motion a constraint forbids: that of a point, or all."""

    CONTACT_3D = 0
    CONTACT_6D = 1
    CONTACT_UNDEFINED = 2


POSITION, VELOCITY, ACCELERATION = KinematicLevel
OP_FRAME, JOINT, FIXED_JOINT, BODY, SENSOR = FrameType
CONTACT_3D, CONTACT_6D = ContactType.CONTACT_3D, ContactType.CONTACT_6D
ALL_FRAMES = FrameType(31)
