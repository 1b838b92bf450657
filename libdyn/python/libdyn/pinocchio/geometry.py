# SPDX-License-Identifier: BSD-2-Clause
"""Volumes on a robot and the pairs of them that are checked, with the names of Pinocchio."""

from __future__ import annotations

import copy
import operator
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from ._arrays import array, instance
from ._queries import (
    CollisionRequest,
    CollisionResult,
    DistanceRequest,
    DistanceResult,
    StdVec_CollisionRequest,
    StdVec_CollisionResult,
    StdVec_DistanceRequest,
    StdVec_DistanceResult,
)
from ._scene import Scene, SceneState
from .containers import StdVec_Bool, StdVec_Scalar, StdVec_SE3, instances, typed_list
from .geometry_object import (
    COLLISION,
    NO_INDEX,
    VISUAL,
    GeometryNoMaterial,
    GeometryObject,
    GeometryPhongMaterial,
    GeometryType,
)
from .serialization import Serializable
from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from .model import Model

__all__ = [
    "COLLISION",
    "VISUAL",
    "CollisionPair",
    "GeometryData",
    "GeometryModel",
    "GeometryNoMaterial",
    "GeometryObject",
    "GeometryPhongMaterial",
    "GeometryType",
    "StdVec_CollisionPair",
    "StdVec_GeometryObject",
]


class CollisionPair:
    """The indices of two volumes."""

    __hash__ = None

    def __init__(self, index1: int = NO_INDEX, index2: int = NO_INDEX) -> None:
        self.first, self.second = operator.index(index1), operator.index(index2)
        if self.first == self.second != NO_INDEX:
            raise ValueError(f"CollisionPair: a volume is not checked against itself ({index1})")

    def copy(self) -> CollisionPair:
        return copy.copy(self)

    def __eq__(self, other: object) -> bool:
        return (self.first, self.second) == (other.first, other.second) if isinstance(other, CollisionPair) else NotImplemented

    def __repr__(self) -> str:
        return f"collision pair ({self.first},{self.second})"


StdVec_CollisionPair = typed_list("StdVec_CollisionPair", instances(CollisionPair), __name__)
StdVec_GeometryObject = typed_list("StdVec_GeometryObject", instances(GeometryObject), __name__)


class GeometryModel(Serializable):
    """Volumes, and the pairs of them that are checked."""

    __hash__ = None

    def __init__(self, other: Optional[GeometryModel] = None) -> None:
        self.geometryObjects = StdVec_GeometryObject()
        self.collisionPairs = StdVec_CollisionPair()
        self._compiled = None
        if other is not None:
            instance(other, GeometryModel, "other")
            self.geometryObjects, self.collisionPairs = other.geometryObjects.copy(), other.collisionPairs.copy()

    ngeoms: int = property(lambda self: len(self.geometryObjects), doc="The number of volumes.")

    @property
    def collisionPairMapping(self) -> Any:
        """The matrix (ngeoms, ngeoms) of the indices of pairs; -1 where there is none."""
        out = np.full((self.ngeoms, self.ngeoms), -1)
        for k, pair in enumerate(self.collisionPairs):
            out[pair.first, pair.second] = out[pair.second, pair.first] = k
        return out

    def addGeometryObject(self, geometry_object: GeometryObject, model: Optional[Model] = None) -> int:
        """Adds a copy of a volume; returns its index. With a model, its joint becomes the one that carries its frame."""
        added = instance(geometry_object, GeometryObject, "geometry_object").copy()
        if model is not None and added.parentFrame < len(model.frames):
            added.parentJoint = model.frames[added.parentFrame].parentJoint
        self.geometryObjects.append(added)
        return self.ngeoms - 1

    def removeGeometryObject(self, name: str) -> None:
        """Removes a volume and its pairs. Raises ValueError if there is none of this name."""
        removed = self.getGeometryId(name)
        if removed == self.ngeoms:
            raise ValueError(f"there is no geometry object '{name}'")
        del self.geometryObjects[removed]
        kept = [p for p in self.collisionPairs if removed not in (p.first, p.second)]
        self.collisionPairs = StdVec_CollisionPair([CollisionPair(p.first - (p.first > removed), p.second - (p.second > removed)) for p in kept])

    def getGeometryId(self, name: str) -> int:
        """Returns the index of a volume; ngeoms if there is none of this name."""
        return next((k for k, x in enumerate(self.geometryObjects) if x.name == name), self.ngeoms)

    def existGeometryName(self, name: str) -> bool:
        return self.getGeometryId(name) < self.ngeoms

    def addCollisionPair(self, collision_pair: CollisionPair) -> None:
        """Adds a pair, unless it is there. Raises ValueError for an index out of range."""
        instance(collision_pair, CollisionPair, "collision_pair")
        if not max(collision_pair.first, collision_pair.second) < self.ngeoms:
            raise ValueError(f"{collision_pair}: an index is not less than ngeoms, {self.ngeoms}")
        if not self.existCollisionPair(collision_pair):
            self.collisionPairs.append(collision_pair.copy())

    def addAllCollisionPairs(self) -> None:
        """Replaces the pairs by all pairs of volumes on different joints."""
        joints = [x.parentJoint for x in self.geometryObjects]
        pairs = [CollisionPair(i, j) for i in range(self.ngeoms) for j in range(i + 1, self.ngeoms) if joints[i] != joints[j]]
        self.collisionPairs = StdVec_CollisionPair(pairs)

    def setCollisionPairs(self, collision_map: ArrayLike, upper: ArrayLike = True) -> None:
        """Replaces the pairs by those (i < j) whose entry of a matrix (ngeoms, ngeoms) is true: (i, j) if upper, else (j, i)."""
        chosen = array(collision_map, (self.ngeoms, self.ngeoms), "collision_map")
        chosen = chosen if upper else chosen.T
        self.collisionPairs = StdVec_CollisionPair([CollisionPair(i, j) for i, j in zip(*np.nonzero(np.triu(chosen, 1)))])

    def removeCollisionPair(self, collision_pair: CollisionPair) -> None:
        """Removes a pair, if it is there."""
        index = self.findCollisionPair(collision_pair)
        if index < len(self.collisionPairs):
            del self.collisionPairs[index]

    def removeAllCollisionPairs(self) -> None:
        self.collisionPairs.clear()

    def existCollisionPair(self, collision_pair: CollisionPair) -> bool:
        return collision_pair in self.collisionPairs

    def findCollisionPair(self, collision_pair: CollisionPair) -> int:
        """Returns the index of a pair; the number of pairs if it is not there."""
        return next((k for k, pair in enumerate(self.collisionPairs) if pair == collision_pair), len(self.collisionPairs))

    def createData(self) -> GeometryData:
        return GeometryData(self)

    def clone(self) -> GeometryModel:
        """Returns a copy with volumes and shapes of its own."""
        return GeometryModel(self)

    copy = clone

    def __copy__(self) -> Self:
        return GeometryModel(self)

    def __deepcopy__(self, memo: Any) -> Self:
        return GeometryModel(self)

    def __getstate__(self) -> Any:
        return {"geometryObjects": self.geometryObjects, "collisionPairs": self.collisionPairs}

    def __setstate__(self, state: Any) -> None:
        self.__dict__.update(state, _compiled=None)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryModel):
            return NotImplemented
        return self.geometryObjects == other.geometryObjects and self.collisionPairs == other.collisionPairs

    def __repr__(self) -> str:
        return f"Nb geometry objects = {self.ngeoms}\n" + "".join(f"{x!r}\n" for x in self.geometryObjects)

    def _scene(self):
        """Returns the compiled Scene of all volumes in pairs, and each such volume's index there. Compiles again after a change."""
        pairs = [(p.first, p.second) for p in self.collisionPairs]
        used = sorted({k for pair in pairs for k in pair})
        key = (pairs, [self.geometryObjects[k].geometry._key() for k in used])
        if self._compiled is None or self._compiled[0] != key:
            index = {k: n for n, k in enumerate(used)}
            shapes = [self.geometryObjects[k].geometry._libdyn() for k in used]
            self._compiled = key, Scene(shapes, [(index[a], index[b]) for a, b in pairs]), index
        return self._compiled[1:]


class GeometryData:
    """Placements of a GeometryModel's volumes in the world, what to check, and results."""

    __hash__ = None

    def __init__(self, geometry_model: Union[GeometryModel, GeometryData]) -> None:
        if isinstance(geometry_model, GeometryData):
            self.__dict__.update(copy.deepcopy({k: v for k, v in vars(geometry_model).items() if k != "_state"}), _state=None)
            return
        pairs = len(instance(geometry_model, GeometryModel, "geometry_model").collisionPairs)
        self.oMg = StdVec_SE3([SE3() for _ in range(geometry_model.ngeoms)])
        self.activeCollisionPairs = StdVec_Bool(pairs, True)
        self.distanceRequests = StdVec_DistanceRequest(pairs, DistanceRequest())
        self.distanceResults = StdVec_DistanceResult(pairs, DistanceResult())
        self.collisionRequests = StdVec_CollisionRequest(pairs, CollisionRequest())
        self.collisionResults = StdVec_CollisionResult(pairs, CollisionResult())
        self.radius = StdVec_Scalar()
        self.innerObjects, self.outerObjects = {}, {}
        self._state = None
        self.fillInnerOuterObjectMaps(geometry_model)

    def fillInnerOuterObjectMaps(self, geometry_model: GeometryModel) -> None:
        """Lists for each joint its volumes (innerObjects) and those that these are checked against (outerObjects)."""
        self.innerObjects, self.outerObjects = {}, {}
        for k, volume in enumerate(geometry_model.geometryObjects):
            self.innerObjects.setdefault(volume.parentJoint, []).append(k)
        for pair in geometry_model.collisionPairs:
            joint = geometry_model.geometryObjects[pair.first].parentJoint
            self.outerObjects.setdefault(joint, []).append(pair.second)

    def activateCollisionPair(self, pair_id: int) -> None:
        """Makes computeCollisions and computeDistances check a pair."""
        self._check(pair_id)
        self.activeCollisionPairs[pair_id] = True

    def deactivateCollisionPair(self, pair_id: int) -> None:
        self._check(pair_id)
        self.activeCollisionPairs[pair_id] = False

    def activateAllCollisionPairs(self) -> None:
        self.activeCollisionPairs[:] = [True] * len(self.activeCollisionPairs)

    def deactivateAllCollisionPairs(self) -> None:
        self.activeCollisionPairs[:] = [False] * len(self.activeCollisionPairs)

    def setGeometryCollisionStatus(self, geom_model: GeometryModel, geom_id: int, enable_collision: bool) -> None:
        """Activates or deactivates all pairs of a volume."""
        for k, pair in enumerate(geom_model.collisionPairs):
            if geom_id in (pair.first, pair.second):
                self.activeCollisionPairs[k] = bool(enable_collision)

    def setActiveCollisionPairs(self, geometry_model: GeometryModel, collision_map: ArrayLike, upper: ArrayLike = True) -> None:
        """Activates the pairs whose entry of a matrix (ngeoms, ngeoms) is true, and deactivates the others."""
        for k, entry in self._entries(geometry_model, collision_map, upper):
            self.activeCollisionPairs[k] = bool(entry)

    def setSecurityMargins(
        self,
        geometry_model: GeometryModel,
        security_margin_map: ArrayLike,
        upper: ArrayLike = True,
        sync_distance_upper_bound: bool = True,
    ) -> None:
        """Sets the security margin [m] of each pair to its entry of a matrix (ngeoms, ngeoms)."""
        for k, margin in self._entries(geometry_model, security_margin_map, upper):
            self.collisionRequests[k].security_margin = float(margin)
            if sync_distance_upper_bound:
                self.collisionRequests[k].distance_upper_bound = float(margin)

    def _entries(self, geometry_model, matrix, upper):
        n = geometry_model.ngeoms
        matrix = array(matrix, (n, n), "map")
        for k, pair in enumerate(geometry_model.collisionPairs):
            i, j = sorted((pair.first, pair.second))
            yield k, matrix[i, j] if upper else matrix[j, i]

    def _check(self, pair_id):
        if not 0 <= pair_id < len(self.activeCollisionPairs):
            raise ValueError(f"pair_id is {pair_id}; there are {len(self.activeCollisionPairs)} pairs")

    def copy(self) -> GeometryData:
        return GeometryData(self)

    __copy__ = copy

    def __deepcopy__(self, memo: Any) -> Self:
        return GeometryData(self)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GeometryData):
            return NotImplemented
        return self.oMg == other.oMg and self.activeCollisionPairs == other.activeCollisionPairs

    def _placed(self, geometry_model, pairs):
        """Returns the SceneState with the volumes of these pairs where oMg has them."""
        scene, index = instance(geometry_model, GeometryModel, "geometry_model")._scene()
        if self._state is None or self._state.scene is not scene:
            self._state = SceneState(scene)
        moved = {k for pair in pairs for k in (geometry_model.collisionPairs[pair].first, geometry_model.collisionPairs[pair].second)}
        self._state.place((index[k], self.oMg[k]) for k in moved)
        return self._state
