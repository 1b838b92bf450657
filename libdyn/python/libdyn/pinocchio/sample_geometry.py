# SPDX-License-Identifier: BSD-2-Clause
"""Volumes of Pinocchio's sample models: spheres at joints, capsules along limbs. Sizes [m] are those of Pinocchio."""

from __future__ import annotations

from typing import TYPE_CHECKING

from . import hppfcl
from .geometry import GeometryModel, GeometryObject
from .spatial import SE3

if TYPE_CHECKING:
    from .model import Model

__all__ = ["buildSampleGeometryModelHumanoid", "buildSampleGeometryModelManipulator"]

_COLOR = (1.0, 1.0, 0.78, 1.0)
# Name of the volume, of the body, height of its centre, radius, length (None: a sphere).
_LIMB = (
    ("shoulder", "shoulder1", 0.0, 0.05, None),
    ("elbow", "elbow", 0.0, 0.05, None),
    ("wrist", "wrist1", 0.0, 0.05, None),
    ("upperarm", "upperarm", 0.5, 0.05, 0.8),
    ("lowerarm", "lowerarm", 0.5, 0.05, 0.8),
    ("effector", "effector", 0.1, 0.05, 0.2),
)
_TRUNK = (("chest", "chest1", 0.0, 0.05, None), ("head", "head2", 0.5, 0.25, None), ("chest2", "chest2", 0.5, 0.05, 0.8))


def _add(model, geometry_model, volumes, prefix=""):
    for name, body, height, radius, length in volumes:
        frame = model.getBodyId(f"{prefix}{body}_body")
        if frame >= len(model.frames):
            raise ValueError(f"the model has no body '{prefix}{body}_body'; give the sample model of the same name")
        placement = SE3.Identity()
        placement.translation[2] = height
        shape = hppfcl.Sphere(radius) if length is None else hppfcl.Capsule(radius, length)
        kind = "SPHERE" if length is None else "CAPSULE"
        volume = GeometryObject(f"{prefix}{name}_object", model.frames[frame].parentJoint, frame, placement, shape, kind, mesh_color=_COLOR)
        geometry_model.addGeometryObject(volume)


def buildSampleGeometryModelManipulator(model: Model) -> GeometryModel:
    """Returns the volumes of buildSampleModelManipulator()."""
    out = GeometryModel()
    _add(model, out, _LIMB)
    return out


def buildSampleGeometryModelHumanoid(model: Model) -> GeometryModel:
    """Returns the volumes of buildSampleModelHumanoid()."""
    out = GeometryModel()
    for prefix in ("rleg_", "lleg_", "rarm_", "larm_"):
        _add(model, out, _LIMB, prefix)
    _add(model, out, _TRUNK)
    return out
