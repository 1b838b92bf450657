# SPDX-License-Identifier: BSD-2-Clause
"""Functions that read a model together with its volumes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn

from .geometry import GeometryType
from .urdf_geometry import buildGeomFromUrdf

if TYPE_CHECKING:
    from ._types import Path

__all__ = ["buildModelsFromMJCF", "buildModelsFromSdf", "buildModelsFromUrdf", "createDatas"]

_BOTH = (GeometryType.COLLISION, GeometryType.VISUAL)


def buildModelsFromUrdf(filename: Path, *args: Any, **named: Any) -> tuple[Any, ...]:
    """Reads a URDF file; returns a tuple of the model and one GeometryModel for each of `geometry_types`.

    Arguments, by name or in this order: package_dirs, root_joint, root_joint_name (by position only if it is a string), verbose, meshLoader,
    geometry_types (default: COLLISION, VISUAL; one of them or a list), mimic.
    """
    names = ["package_dirs", "root_joint", "verbose", "meshLoader", "geometry_types", "mimic"]
    if len(args) >= 3 and isinstance(args[2], str):
        names.insert(2, "root_joint_name")
    if len(args) > len(names):
        raise TypeError(f"buildModelsFromUrdf takes at most {len(names) + 1} arguments by position, not {len(args) + 1}")
    for name, value in zip(names, args):
        if name in named:
            raise TypeError(f"buildModelsFromUrdf got two values for {name}")
        named[name] = value
    return _models_from_urdf(filename, **named)


def _models_from_urdf(
    filename, package_dirs=None, root_joint=None, root_joint_name=None, verbose=False, meshLoader=None, geometry_types=None, mimic=False
):
    from . import buildModelFromUrdf

    root = [x for x in (root_joint, root_joint_name) if x is not None]
    if root_joint is None and root_joint_name is not None:
        raise ValueError("root_joint_name needs a root_joint")
    model = buildModelFromUrdf(filename, *root, mimic=mimic)
    types = _BOTH if geometry_types is None else geometry_types
    types = types if hasattr(types, "__iter__") else (types,)
    return (model, *(buildGeomFromUrdf(model, filename, t, package_dirs=package_dirs, mesh_loader=meshLoader) for t in types))


def buildModelsFromSdf(filename: Path, *args: Any, **named: Any) -> NoReturn:
    """Not there. Raises NotImplementedError."""
    raise NotImplementedError("libdyn.pinocchio reads no SDF files; use a URDF file")


def buildModelsFromMJCF(filename: Path, *args: Any, **named: Any) -> NoReturn:
    """Not there. Raises NotImplementedError."""
    raise NotImplementedError("libdyn.pinocchio reads no MJCF files; use a URDF file")


def createDatas(*models: Any) -> tuple[Any, ...]:
    """Returns a tuple with createData() of each model; None stays None."""
    return tuple(None if model is None else model.createData() for model in models)
