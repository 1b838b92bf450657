# SPDX-License-Identifier: BSD-2-Clause
"""Masses and centres of mass, of the robot and of the subtrees of joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

import numpy as np

import libdyn as dyn

from .calls import compiled, prepare
from .convert import index
from .enums import KinematicLevel
from .kinematics import PLACEMENTS

if TYPE_CHECKING:
    from ._types import Array
    from .data import Data
    from .model import Model

_FIELDS = ("com", "vcom", "acom")
_MOTIONS = ("oMi", "v", "a")


def computeTotalMass(model: Model, data: Optional[Data] = None) -> float:
    """Returns the mass of all moving bodies [kg]; with data, also data.mass[0]."""
    mass = float(compiled(model, "computeTotalMass").subtree_masses[0])
    if data is not None:
        data.mass[0] = mass
    return mass


def computeSubtreeMasses(model: Model, data: Data) -> None:
    """Computes data.mass, the mass of each joint's subtree [kg]."""
    for i, mass in enumerate(compiled(model, "computeSubtreeMasses").subtree_masses.tolist()):
        data.mass[i] = mass


def centerOfMass(model: Model, data: Data, *arguments: Any, **named: Any) -> Array:
    """Returns the centre of mass (3,) in the world [m]; also data.com, mass, and with v and a data.vcom and acom.

    Arguments: q[, v[, a]], then compute_subtree_coms; or a kinematic level (POSITION, VELOCITY, ACCELERATION), or nothing, for the state of the last
    forwardKinematics. com[i] is the centre of the subtree of joint i, in the joint's frame; i = 0 is the robot's, in the world.
    """
    c, _ = prepare(model, data, "centerOfMass")
    given = [x for x in arguments if not isinstance(x, (bool, np.bool_))]
    given += [named[key] for key in ("q", "v", "a", "kinematic_level") if key in named]
    if given and isinstance(given[0], (int, np.integer)) or not given:
        level = KinematicLevel(int(given[0])) if given else KinematicLevel.ACCELERATION
        before = "forwardKinematics(model, data, q, v, a)"
        available = level if given else max((k for k in range(3) if _MOTIONS[k] in data._sources), default=0)
        state = data.source(_MOTIONS[available], "centerOfMass", before)
    else:
        level = KinematicLevel(len(given) - 1)
        vectors = [take(x, "centerOfMass", name) for take, x, name in zip((c.q_in, c.v_in, c.v_in), given, ("q", "v", "a"))]
        state = data.state(*vectors)
        data.note((*PLACEMENTS, *("v", "a")[:level]), state)
    data.note(("mass", *_FIELDS[: level + 1]), state)
    return data.com[0]


def jacobianCenterOfMass(model: Model, data: Data, *arguments: Any, **named: Any) -> Array:
    """Returns the Jacobian (3, nv) of the centre of mass; also data.Jcom, com (here all in the world), mass, J.

    Arguments: q, or nothing for the state of the last forwardKinematics; then compute_subtree_coms.
    """
    c, d = prepare(model, data, "jacobianCenterOfMass")
    state = _state_of(c, data, [x for x in (*arguments, *filter(None.__ne__, [named.get("q")])) if not isinstance(x, bool)], "jacobianCenterOfMass")
    Jcom = data.Jcom = c.v_out(dyn.jacobian_center_of_mass(c.model, d, state.q))
    data.note(("mass", "J", "oMi"), state)
    data.note_as("com", state, "com_in_world")
    return Jcom


def _state_of(c, data, given, function):
    """Returns the state of q, or that of the last forwardKinematics."""
    if given:
        state = data.state(c.q_in(given[0], function))
        data.note(PLACEMENTS, state)
        return state
    return data.source("oMi", function, "forwardKinematics(model, data, q)")


def jacobianSubtreeCenterOfMass(model: Model, data: Data, *arguments: Any) -> Array:
    """Returns the Jacobian (3, nv) of the centre of mass of the subtree of a joint. Arguments: [q,] subtree_root_joint_id."""
    c, _ = prepare(model, data, "jacobianSubtreeCenterOfMass")
    state = _state_of(c, data, arguments[:-1], "jacobianSubtreeCenterOfMass")
    data.note(("mass", "J"), state)
    data.note_as("com", state, "com_in_world")
    return _subtree_jacobian(model, c, state, arguments[-1], "jacobianSubtreeCenterOfMass")


def getJacobianSubtreeCenterOfMass(model: Model, data: Data, subtree_root_joint_id: int) -> Array:
    """Returns the same at the state of the last jacobianCenterOfMass."""
    c, _ = prepare(model, data, "getJacobianSubtreeCenterOfMass")
    state = data.source("J", "getJacobianSubtreeCenterOfMass", "jacobianCenterOfMass(model, data, q)")
    return _subtree_jacobian(model, c, state, subtree_root_joint_id, "getJacobianSubtreeCenterOfMass")


def _subtree_jacobian(model, c, state, root, function):
    root = index(root, model.njoints, function, "subtree_root_joint_id")
    masses, centres = c.subtree_masses, state.bodies().centres
    total = masses[root]
    if not total > 0:
        raise ValueError(f"{function}: the subtree of joint {root} has no mass")
    J, out = state.J(), np.zeros((3, c.nv))
    for i in range(1, c.njoints):
        # A joint inside the subtree moves what it carries; one on the way to it moves the whole subtree.
        moved = i if root in model.supports[i] else root if i in model.supports[root] else None
        if moved is not None and model.nvs[i]:
            columns = slice(model.idx_vs[i], model.idx_vs[i] + model.nvs[i])
            out[:, columns] = masses[moved] / total * (J[:3, columns] + np.cross(J[3:, columns].T, centres[moved]).T)
    return out
