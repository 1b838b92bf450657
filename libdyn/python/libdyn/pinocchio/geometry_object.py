# SPDX-License-Identifier: BSD-2-Clause
"""A volume on a joint, and its look, with the names of Pinocchio."""

from __future__ import annotations

import copy
import enum
import operator
from typing import TYPE_CHECKING, Any

import numpy as np

from . import hppfcl
from ._arrays import array
from .serialization import Serializable
from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

NO_INDEX = 2**64 - 1  # stands for no frame or no volume


class GeometryType(enum.IntEnum):
    """The purpose of a volume."""

    VISUAL = 0
    COLLISION = 1


VISUAL, COLLISION = GeometryType.VISUAL, GeometryType.COLLISION


class GeometryNoMaterial:
    """The material of a volume whose look is in its mesh."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, GeometryNoMaterial)

    __hash__ = None


class GeometryPhongMaterial:
    """Colours (r, g, b, a) and shininess of a volume."""

    __hash__ = None

    def __init__(
        self,
        meshEmissionColor: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        meshSpecularColor: ArrayLike = (0.0, 0.0, 0.0, 1.0),
        meshShininess: float = 0.5,
    ) -> None:
        self.meshEmissionColor = np.array(meshEmissionColor, dtype=float)
        self.meshSpecularColor = np.array(meshSpecularColor, dtype=float)
        self.meshShininess = float(meshShininess)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryPhongMaterial):
            return NotImplemented
        mine, theirs = vars(self), vars(other)
        return all(np.array_equal(mine[name], theirs[name]) for name in mine)


class GeometryObject(Serializable):
    """A volume on a joint: GeometryObject(name, parent_joint[, parent_frame], placement, collision_geometry, ...).

    placement: the pose in the joint's frame. collision_geometry: a shape of hppfcl. mesh_path, mesh_scale, mesh_color and so on are for viewers.
    """

    __hash__ = None
    _options = (
        ("mesh_path", ""),
        ("mesh_scale", (1.0, 1.0, 1.0)),
        ("override_material", False),
        ("mesh_color", (0.0, 0.0, 0.0, 1.0)),
        ("mesh_texture_path", ""),
        ("mesh_material", None),
    )

    def __init__(self, name: Any, *args: Any, **named: Any) -> None:
        if isinstance(name, GeometryObject):
            self.__dict__.update(copy.deepcopy(vars(name)))
            return
        args = list(args)
        self.name = str(name)
        # Integers come first: joint and frame, or the other way round before placement and geometry changed places.
        numbers = [operator.index(args.pop(0)) for _ in range(2) if args and not isinstance(args[0], (SE3, hppfcl.CollisionGeometry))]
        objects = [args.pop(0) for _ in range(2) if args and isinstance(args[0], (SE3, hppfcl.CollisionGeometry))]
        if len(numbers) == 2 and objects and isinstance(objects[0], hppfcl.CollisionGeometry):
            numbers.reverse()
        joint, frame = (numbers + [None, None])[:2]
        self.parentJoint = operator.index(named.pop("parent_joint", joint))
        frame = named.pop("parent_frame", frame)
        self.parentFrame = NO_INDEX if frame is None else operator.index(frame)
        self.placement = named.pop("placement", next((x for x in objects if isinstance(x, SE3)), None))
        self.geometry = named.pop("collision_geometry", next((x for x in objects if isinstance(x, hppfcl.CollisionGeometry)), None))
        if not isinstance(self.geometry, hppfcl.CollisionGeometry):
            raise TypeError(f"collision_geometry must be a shape of hppfcl, not {type(self.geometry).__name__}")
        options = dict(self._options, **dict(zip((key for key, _ in self._options), args)))
        unknown = set(named) - set(options)
        if unknown or len(args) > len(options):
            raise TypeError(f"GeometryObject has no argument {', '.join(sorted(unknown)) or args[-1]!r}")
        options.update(named)
        self.meshPath, self.meshTexturePath = str(options["mesh_path"]), str(options["mesh_texture_path"])
        self.meshScale = array(options["mesh_scale"], (3,), "mesh_scale").copy()
        self.meshColor = array(options["mesh_color"], (4,), "mesh_color").copy()
        self.overrideMaterial = bool(options["override_material"])
        self.meshMaterial = options["mesh_material"] or GeometryNoMaterial()
        self.disableCollision = False

    @property
    def placement(self) -> SE3:
        """The pose in the joint's frame."""
        return self._placement

    @placement.setter
    def placement(self, value: SE3) -> None:
        if not isinstance(value, SE3):
            raise TypeError(f"placement must be an SE3, not {type(value).__name__}")
        self._placement = value.copy()

    def clone(self) -> GeometryObject:
        """Returns a copy with a shape of its own."""
        return copy.deepcopy(self)

    copy = clone

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryObject):
            return NotImplemented
        mine, theirs = vars(self), vars(other)
        return all(np.array_equal(x, theirs[key]) if isinstance(x, np.ndarray) else x == theirs[key] for key, x in mine.items())

    def __repr__(self) -> str:
        return f"<GeometryObject '{self.name}': {self.geometry!r}>"

    @staticmethod
    def CreateCapsule(radius: float, length: float) -> GeometryObject:
        return GeometryObject("", 0, 0, SE3.Identity(), hppfcl.Capsule(radius, length))


NO_INDEX = 2**64 - 1
