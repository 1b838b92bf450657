# SPDX-License-Identifier: BSD-2-Clause
"""Models from URDF files. libdyn's reader reads them; joints and frames get Pinocchio's numbers."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import _core
from . import joints as joint_models
from .enums import FrameType
from .frames import Frame
from .inertia import Inertia
from .joints import JointModel, JointModelMimic
from .model import Model
from .spatial import SE3

if TYPE_CHECKING:
    from ._types import Path

_NO_LIMIT = {"lower": -np.inf, "upper": np.inf, "velocity_limit": np.inf, "effort_limit": np.inf}
_OF_AXIS = {"revolute": ("R", "Revolute"), "continuous": ("RUB", "RevoluteUnbounded"), "prismatic": ("P", "Prismatic")}
_OTHERS = {"free_flyer": "FreeFlyer", "planar": "Planar", "spherical": "Spherical", "translation": "Translation", "spherical_zyx": "SphericalZYX"}


def _arguments(arguments, named):
    """Returns root joint, its name, the model to extend, and whether mimic joints are coupled."""
    out = {"root_joint": None, "root_joint_name": "root_joint", "model": None, "mimic": False}
    kinds = {JointModel: "root_joint", str: "root_joint_name", Model: "model", bool: "mimic"}
    for x in arguments:
        key = next((key for kind, key in kinds.items() if isinstance(x, kind)), None)
        if key is None and x is not None:
            raise TypeError(f"a {type(x).__name__} is no argument; they are root_joint, root_joint_name, model, mimic")
        if key is not None:
            out[key] = x
    unknown = named.keys() - out.keys() - {"verbose"}
    if unknown:
        raise TypeError(f"unknown arguments: {', '.join(sorted(unknown))}")
    out.update((key, x) for key, x in named.items() if key != "verbose")
    return out


def buildModelFromUrdf(urdf_filename: Path, *arguments: Any, **named: Any) -> Any:
    """Returns the Model of a URDF file. Arguments: [root_joint[, root_joint_name],] [model,] mimic=False.

    With a root joint, it connects the world and the root link; without one, the root link is fixed. `model` is extended and returned. With
    mimic=True, mimic joints follow their masters; else they are independent. Raises libdyn.Error with the file and line of what is wrong.
    """
    given = _arguments(arguments, named)
    mimic = "coupled" if given["mimic"] else "independent"
    robot = _core._load(os.fspath(urdf_filename), root="fixed", mimic=mimic, order="name", continuous="unit_circle", inertias="any")
    return _convert(robot, given)


def buildModelFromXML(urdf_xml_stream: str, *arguments: Any, **named: Any) -> Any:
    """Returns the Model of the text of a URDF file. Arguments are those of buildModelFromUrdf."""
    given = _arguments(arguments, named)
    mimic = "coupled" if given["mimic"] else "independent"
    robot = _core.parse(urdf_xml_stream, "<text>", root="fixed", mimic=mimic, order="name", continuous="unit_circle", inertias="any")
    return _convert(robot, given)


def _convert(robot, given):
    """Adds the joints and frames of libdyn's description to a model; returns it."""
    model = Model() if given["model"] is None else given["model"]
    model.name = robot.name
    bodies = list(robot.bodies)
    if not given["root_joint_name"]:
        raise ValueError("root_joint_name is empty")
    frames = [0] * len(bodies)  # the frame of each body
    for k, body in enumerate(bodies[1:], 1):
        inertia, placement = Inertia(body.inertia), SE3(body.joint.placement)
        if k == 1:
            frames[k] = _add_root(model, body.name, inertia, given)
            continue
        before = frames[body.parent]
        parent = model.frames[before]
        at = parent.placement * placement
        if body.joint.type == "fixed":
            fixed = model.addFrame(Frame(body.joint.name, parent.parentJoint, before, at, FrameType.FIXED_JOINT, inertia))
            frames[k] = model.addBodyFrame(body.name, parent.parentJoint, at, fixed)
        else:
            joint, limits = _joint(model, body.joint)
            i = model.addJoint(parent.parentJoint, joint, at, body.joint.name, **limits)
            frame = model.addJointFrame(i, before)
            _append(model, i, inertia)
            frames[k] = model.addBodyFrame(body.name, i, SE3.Identity(), frame)
    return model


def _append(model, joint, inertia):
    """Adds a body's inertia to a joint, if it has any."""
    if inertia.mass or np.any(np.asarray(inertia.rotational)):
        model.appendBodyToJoint(joint, inertia, SE3.Identity())


def _add_root(model, name, inertia, given):
    """Adds the root link, fixed to the world or carried by the root joint; returns its frame."""
    if given["root_joint"] is None:
        return model.addFrame(Frame(name, 0, 0, SE3.Identity(), FrameType.BODY, inertia))
    if model.existJointName(given["root_joint_name"]):
        raise ValueError(f"a joint is called '{given['root_joint_name']}' already; give another root_joint_name")
    i = model.addJoint(0, given["root_joint"], SE3.Identity(), given["root_joint_name"])
    frame = model.addJointFrame(i, 0)
    _append(model, i, inertia)
    return model.addBodyFrame(name, i, SE3.Identity(), frame)


def _joint(model, joint):
    """Returns the joint model of libdyn's description of a joint, and its limits by the names of addJoint."""
    kind, parameters = joint.type, joint.parameters
    if kind in _OF_AXIS:
        axis = np.array(parameters["axis"], dtype=float)
        axis = axis / np.linalg.norm(axis)
        short, long = _OF_AXIS[kind]
        letter = next((a for a, unit in joint_models.AXES.items() if np.allclose(axis, unit, rtol=0, atol=1e-12)), None)
        made = getattr(joint_models, f"JointModel{short}{letter}")() if letter else getattr(joint_models, f"JointModel{long}Unaligned")(axis)
    elif kind in _OTHERS:
        made = getattr(joint_models, f"JointModel{_OTHERS[kind]}")()
    else:
        raise NotImplementedError(f"joint '{joint.name}' of type {kind} has no counterpart in Pinocchio; libdyn.load and libdyn.compile read it")
    if joint.coupling is not None:
        _, master, how = joint.coupling
        offset, scaling = how["coefficients"]
        made = JointModelMimic(made, model.joints[model.getJointId(master)], scaling, offset)
        return made, {}
    return made, {
        "max_effort": _limit(joint, "effort_limit", made.nv),
        "max_velocity": _limit(joint, "velocity_limit", made.nv),
        "min_config": _positions(made, _limit(joint, "lower", made.nq), -1.01),
        "max_config": _positions(made, _limit(joint, "upper", made.nq), 1.01),
        "friction": _per_dof(joint.friction, made.nv),
        "damping": _per_dof(joint.damping, made.nv),
    }


def _per_dof(numbers, nv):
    return np.array(numbers) if len(numbers) == nv else np.full(nv, numbers[0] if len(numbers) else 0.0)


def _limit(joint, name, size):
    numbers = getattr(joint, name)
    return np.array(numbers) if len(numbers) == size else np.full(size, numbers[0] if len(numbers) == 1 and size <= 2 else _NO_LIMIT[name])


def _positions(made, limits, of_rotation):
    """Returns limits of coordinates; those of quaternions and (cos, sin) pairs are Pinocchio's, just beyond one."""
    return np.where(made.hasConfigurationLimit(), limits, of_rotation)
