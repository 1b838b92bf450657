# SPDX-License-Identifier: BSD-2-Clause
"""Sample models: a manipulator and humanoids, with the structure and the names of Pinocchio's."""

from __future__ import annotations

import numpy as np

from . import _random, joints
from .inertia import Inertia
from .model import Model
from .spatial import SE3

_HALF_TURN = np.diag([1.0, -1.0, -1.0])  # about x
_QUARTER_TURN = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # about y
_RANGE, _LIMIT = 3.14, 10.0
_LEG = ("RX", "RY", "RZ", "RY", "RY", "RX")


def _light():
    return Inertia(0.1, np.zeros(3), 0.01 * np.eye(3))


def _long():
    return Inertia(1.0, np.array([0.0, 0.0, 0.5]), np.eye(3))


def _up(height=1.0):
    return SE3(np.eye(3), np.array([0.0, 0.0, height]))


def _joint(kind):
    return getattr(joints, f"JointModel{kind}")()


def _add(model, joint, parent, name, placement, inertia, limits):
    """Adds a joint with its frame, a body and its frame; returns the joint's index. `limits` are effort, velocity, lower, upper."""
    i = model.addJoint(parent, joint, placement, name + "_joint", *limits)
    model.addJointFrame(i)
    model.appendBodyToJoint(i, inertia, SE3.Identity())
    model.addBodyFrame(name + "_body", i, SE3.Identity(), -1)
    return i


def _limits(joint):
    return (np.full(joint.nv, _LIMIT), np.full(joint.nv, _LIMIT), np.full(joint.nq, -_RANGE), np.full(joint.nq, _RANGE))


def _add_manipulator(model, root, placement, prefix="", mimic=False):
    """Adds an arm of six joints: shoulder, elbow, wrist. With mimic, the last follows the one before."""
    parts = (
        ("RX", "shoulder1", placement, _light(), ()),
        ("RY", "shoulder2", SE3.Identity(), _light(), ()),
        ("RZ", "shoulder3", SE3.Identity(), _long(), ("upperarm",)),
        ("RY", "elbow", _up(), _long(), ("lowerarm",)),
        ("RX", "wrist1", _up(), _light(), ()),
        ("RY", "wrist2", SE3.Identity(), _long(), ("effector",)),
    )
    i = root
    for kind, name, where, inertia, bodies in parts:
        joint = _joint(kind)
        if mimic and name == "wrist2":
            joint, name = joints.JointModelMimic(joint, model.joints[i], 2.5, 0.75), "wrist1_mimic"
        i = _add(model, joint, i, prefix + name, where, inertia, _limits(joint))
        for body in bodies:
            model.addBodyFrame(f"{prefix}{body}_body", i, SE3.Identity(), -1)


def buildSampleModelManipulator(mimic: bool = False) -> Model:
    """Returns the Model of an arm of six joints. With mimic, the last joint follows the one before."""
    model = Model()
    model.name = "manipulator"
    _add_manipulator(model, 0, SE3.Identity(), mimic=mimic)
    return model


def _root_joint(using_free_flyer):
    if using_free_flyer:
        return joints.JointModelFreeFlyer()
    return joints.JointModelComposite(joints.JointModelTranslation()).addJoint(joints.JointModelSphericalZYX())


def buildSampleModelHumanoid(using_free_flyer: bool = True) -> Model:
    """Returns the Model of a humanoid: legs, chest, head and arms. Its root is a free flyer, or a translation and three angles."""
    model = Model()
    model.name = "humanoid"
    root = model.addJoint(0, _root_joint(using_free_flyer), SE3.Identity(), "root_joint")
    if using_free_flyer:
        model.lowerPositionLimit[3:7], model.upperPositionLimit[3:7] = -1.0, 1.0
    model.appendBodyToJoint(root, _light(), SE3.Identity())
    model.addJointFrame(root)
    for prefix, y in (("rleg_", -0.2), ("lleg_", 0.2)):
        _add_manipulator(model, root, SE3(_HALF_TURN, np.array([0.0, y, -0.1])), prefix)
    for foot in ("rleg_wrist2_joint", "lleg_wrist2_joint"):
        model.jointPlacements[model.getJointId(foot)] = SE3(_QUARTER_TURN, np.zeros(3))
    i = root
    for kind, name, where, inertia in (("RX", "chest1", 0.0, _light()), ("RY", "chest2", 0.0, _long())):
        joint = _joint(kind)
        i = _add(model, joint, i, name, _up(where), inertia, _limits(joint))
    chest = i
    for kind, name, where, inertia in (("RX", "head1", 1.0, _light()), ("RY", "head2", 0.0, _long())):
        joint = _joint(kind)
        i = _add(model, joint, i, name, _up(where), inertia, _limits(joint))
    for prefix, y in (("rarm_", -0.3), ("larm_", 0.3)):
        _add_manipulator(model, chest, SE3(_HALF_TURN, np.array([0.0, y, 1.0])), prefix)
    return model


def _add_random(model, joint, parent, name, placement=None):
    """Adds a joint with random limits, a random placement and a random body."""
    limits = (
        _random.uniform(joint.nv) + 1,
        _random.uniform(joint.nv) + 1,
        _random.uniform(joint.nq) - 1,
        _random.uniform(joint.nq) + 1,
    )
    return _add(model, joint, parent, name, SE3.Random() if placement is None else placement, Inertia.Random(), limits)


def buildSampleModelHumanoidRandom(using_free_flyer: bool = True, mimic: bool = False) -> Model:
    """Returns the Model of a humanoid with random placements, inertias and limits. With mimic, the joint larm6 follows larm5."""
    model = Model()
    model.name = "humanoid"
    root = _add_random(model, _root_joint(using_free_flyer), 0, "root", SE3.Identity())
    if using_free_flyer:
        model.lowerPositionLimit[3:7], model.upperPositionLimit[3:7] = -1.0, 1.0
    chest = root
    for limb, kinds in (("lleg", _LEG), ("rleg", _LEG), ("trunk", ("RY", "RZ")), ("rarm", _LEG), ("larm", _LEG)):
        i = chest
        for k, kind in enumerate(kinds, 1):
            name = ("torso1", "chest")[k - 1] if limb == "trunk" else f"{limb}{k}"
            joint = _joint(kind)
            if mimic and name == "larm6":
                joint = joints.JointModelMimic(joint, model.joints[i], 2.5, 0.75)
            i = _add_random(model, joint, i, name)
        if limb == "trunk":
            chest = i
    return model
