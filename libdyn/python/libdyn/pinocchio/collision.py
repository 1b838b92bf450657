# SPDX-License-Identifier: BSD-2-Clause
"""Placements of volumes, collision checks and distances, with the names of Pinocchio."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn, Optional, Union

import numpy as np

from ._arrays import instance
from ._queries import check, collide, distance, measure
from .geometry import GeometryData, GeometryModel

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._queries import CollisionRequest, CollisionResult, DistanceRequest, DistanceResult
    from ._transform import Transform3f
    from .data import Data
    from .geometry_object import GeometryObject
    from .model import Model
    from .spatial import SE3

__all__ = [
    "ComputeCollision",
    "ComputeDistance",
    "computeBodyRadius",
    "computeCollision",
    "computeCollisions",
    "computeDistance",
    "computeDistances",
    "updateGeometryPlacements",
]


def updateGeometryPlacements(
    model: Model,
    data: Data,
    geometry_model: GeometryModel,
    geometry_data: GeometryData,
    q: Optional[ArrayLike] = None,
) -> None:
    """Places all volumes in the world by the poses in data.oMi. With q (nq,), computes these first."""
    if q is not None:
        from .kinematics import forwardKinematics

        forwardKinematics(model, data, q)
    instance(geometry_model, GeometryModel, "geometry_model")
    instance(geometry_data, GeometryData, "geometry_data")
    oMi = data.oMi
    for k, volume in enumerate(geometry_model.geometryObjects):
        geometry_data.oMg[k] = oMi[volume.parentJoint] * volume.placement


def _shapes(geometry_model, pair):
    pair = geometry_model.collisionPairs[pair]
    return geometry_model.geometryObjects[pair.first], geometry_model.geometryObjects[pair.second]


def _checked(geometry_model, geometry_data):
    """Returns the indices of pairs that are active and whose volumes may collide."""
    active = [k for k, on in enumerate(geometry_data.activeCollisionPairs) if on]
    return [k for k in active if not any(x.disableCollision for x in _shapes(geometry_model, k))]


def computeCollision(
    geometry_model: GeometryModel,
    geometry_data: GeometryData,
    pair_index: int,
    collision_request: Optional[CollisionRequest] = None,
) -> bool:
    """Returns whether a pair collides where geometry_data.oMg has its volumes; fills geometry_data.collisionResults[pair_index]."""
    instance(geometry_data, GeometryData, "geometry_data")._check(pair_index)
    result = geometry_data.collisionResults[pair_index]
    result.clear()
    a, b = _shapes(geometry_model, pair_index)
    if a.disableCollision or b.disableCollision:
        return False
    state = geometry_data._placed(geometry_model, [pair_index])
    return check(state, pair_index, collision_request or geometry_data.collisionRequests[pair_index], result, a.geometry, b.geometry)


def computeCollisions(*args: Any, **named: Any) -> bool:
    """computeCollisions(geometry_model, geometry_data, stop_at_first_collision=False) returns whether any active pair collides.

    computeCollisions(model, data, geometry_model, geometry_data, q, stop_at_first_collision=False) places the volumes at q first.
    """
    geometry_model, geometry_data, rest = _placed_by(args, named)
    stop = rest[0] if rest else named.get("stop_at_first_collision", False)
    pairs = _checked(geometry_model, geometry_data)
    state = geometry_data._placed(geometry_model, pairs) if pairs else None
    found = False
    for k in pairs:
        a, b = _shapes(geometry_model, k)
        if check(state, k, geometry_data.collisionRequests[k], geometry_data.collisionResults[k], a.geometry, b.geometry):
            geometry_data.collisionPairIndex = k
            found = True
            if stop:
                break
    return found


def computeDistance(geometry_model: GeometryModel, geometry_data: GeometryData, pair_index: int) -> DistanceResult:
    """Returns the DistanceResult of a pair, which is also geometry_data.distanceResults[pair_index]."""
    instance(geometry_data, GeometryData, "geometry_data")._check(pair_index)
    result = geometry_data.distanceResults[pair_index]
    a, b = _shapes(geometry_model, pair_index)
    measure(geometry_data._placed(geometry_model, [pair_index]), pair_index, result, a.geometry, b.geometry)
    return result


def computeDistances(*args: Any, **named: Any) -> int:
    """computeDistances(geometry_model, geometry_data) fills geometry_data.distanceResults of active pairs; returns the index of the nearest pair.

    computeDistances(model, data, geometry_model, geometry_data, q) places the volumes at q first. Without pairs the number of pairs is returned.
    """
    geometry_model, geometry_data, _ = _placed_by(args, named)
    pairs = _checked(geometry_model, geometry_data)
    state = geometry_data._placed(geometry_model, pairs) if pairs else None
    distances = []
    for k in pairs:
        a, b = _shapes(geometry_model, k)
        distances.append(measure(state, k, geometry_data.distanceResults[k], a.geometry, b.geometry))
    return pairs[int(np.argmin(distances))] if pairs else len(geometry_model.collisionPairs)


def _placed_by(args, named):
    """Reads the arguments of the two forms; places the volumes in the second form."""
    args = list(args) + [named[k] for k in ("model", "data", "geometry_model", "geometry_data", "q") if k in named]
    at = 0 if args and isinstance(args[0], GeometryModel) else 2
    if len(args) < (2 if at == 0 else 5):
        raise TypeError("give geometry_model and geometry_data, or model, data, geometry_model, geometry_data and q")
    geometry_model = instance(args[at], GeometryModel, "geometry_model")
    geometry_data = instance(args[at + 1], GeometryData, "geometry_data")
    if at == 0:
        return geometry_model, geometry_data, args[2:]
    updateGeometryPlacements(*args[:5])
    return geometry_model, geometry_data, args[5:]


def computeBodyRadius(model: Model, geometry_model: GeometryModel, geometry_data: GeometryData) -> NoReturn:
    """Not computed. Raises NotImplementedError."""
    raise NotImplementedError("libdyn keeps no radius of a joint's volumes; computeDistances gives distances of pairs")


class _Functor:
    """A check of two volumes, at poses that are given with each call."""

    def __init__(self, geometry_object1: GeometryObject, geometry_object2: GeometryObject) -> None:
        self._objects = geometry_object1, geometry_object2

    def getGeometryObject1(self) -> Any:
        return self._objects[0]

    def getGeometryObject2(self) -> Any:
        return self._objects[1]

    def _run(self, function, tf1, tf2, request, result):
        a, b = self._objects
        return function(a.geometry, tf1, b.geometry, tf2, request, result)


class ComputeCollision(_Functor):
    """ComputeCollision(geometry_object1, geometry_object2).run(pose1, pose2, request, result) returns the number of contacts."""

    def run(self, tf1: Union[SE3, Transform3f], tf2: Union[SE3, Transform3f], request: CollisionRequest, result: CollisionResult) -> Any:
        return self._run(collide, tf1, tf2, request, result)


class ComputeDistance(_Functor):
    """ComputeDistance(geometry_object1, geometry_object2).run(pose1, pose2, request, result) returns the distance [m]."""

    def run(self, tf1: Union[SE3, Transform3f], tf2: Union[SE3, Transform3f], request: DistanceRequest, result: DistanceResult) -> Any:
        return self._run(distance, tf1, tf2, request, result)
