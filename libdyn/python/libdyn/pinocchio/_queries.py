# SPDX-License-Identifier: BSD-2-Clause
"""Requests and results of collision checks, and checks of two shapes, with the names of hpp-fcl."""

from __future__ import annotations

import enum
import functools
import math
from typing import TYPE_CHECKING, Any, Optional, Union

import numpy as np

from ._scene import Scene, SceneState
from .containers import instances, typed_list
from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ._transform import Transform3f
    from ._types import Array
    from .hppfcl import CollisionGeometry


class CollisionRequestFlag(enum.IntFlag):
    """What a collision check computes besides its answer."""

    CONTACT = 1
    DISTANCE_LOWER_BOUND = 2
    NO_REQUEST = 4096


class CollisionRequest:
    """What a collision check computes. Two shapes collide if their distance is at most security_margin [m]."""

    def __init__(self, flag: CollisionRequestFlag = CollisionRequestFlag.NO_REQUEST, num_max_contacts: int = 1) -> None:
        self.enable_contact = bool(flag & CollisionRequestFlag.CONTACT)
        self.enable_distance_lower_bound = bool(flag & CollisionRequestFlag.DISTANCE_LOWER_BOUND)
        self.num_max_contacts = int(num_max_contacts)
        self.security_margin = 0.0
        self.break_distance = 1e-3
        self.distance_upper_bound = math.inf


class DistanceRequest:
    """What a distance computation gives. libdyn always computes nearest points and signed distances."""

    def __init__(self, enable_nearest_points: bool = True, rel_err: float = 0.0, abs_err: float = 0.0) -> None:
        self.enable_nearest_points, self.rel_err, self.abs_err = bool(enable_nearest_points), float(rel_err), float(abs_err)
        self.enable_signed_distance = True


class Contact:
    """A contact of two shapes, in the world. The normal points from the first to the second; penetration_depth is negative if they overlap [m]."""

    def __init__(
        self,
        o1: Optional[CollisionGeometry] = None,
        o2: Optional[CollisionGeometry] = None,
        pos: Optional[ArrayLike] = None,
        normal: Optional[ArrayLike] = None,
        depth: float = math.inf,
    ) -> None:
        unknown = np.full(3, np.nan)
        self.o1, self.o2, self.penetration_depth = o1, o2, float(depth)
        self.pos = unknown if pos is None else np.array(pos, dtype=float)
        self.normal = unknown if normal is None else np.array(normal, dtype=float)
        half = 0.5 * self.penetration_depth * self.normal if pos is not None else unknown
        self.nearest_points = [self.pos - half, self.pos + half]

    def getNearestPoint1(self) -> Array:
        return self.nearest_points[0]

    def getNearestPoint2(self) -> Array:
        return self.nearest_points[1]


class CollisionResult:
    """Contacts of two shapes. A check without enable_contact leaves one contact without numbers if the shapes collide."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        self._contacts = StdVec_Contact()
        self.distance_lower_bound = math.inf

    def addContact(self, contact: Contact) -> None:
        self._contacts.append(contact)

    def isCollision(self) -> bool:
        return len(self._contacts) > 0

    def numContacts(self) -> int:
        return len(self._contacts)

    def getContact(self, index: int) -> Contact:
        return self._contacts[index]

    def getContacts(self) -> Any:
        return self._contacts


class DistanceResult:
    """The distance of two shapes [m], negative if they overlap, with nearest points and the normal from the first to the second, in the world."""

    def __init__(self, min_distance: float = math.inf) -> None:
        self.clear()
        self.min_distance = float(min_distance)

    def clear(self) -> None:
        self.min_distance = math.inf
        self.normal = np.full(3, np.nan)
        self.nearest_points = [np.full(3, np.nan), np.full(3, np.nan)]
        self.o1 = self.o2 = None

    def getNearestPoint1(self) -> Array:
        return self.nearest_points[0]

    def getNearestPoint2(self) -> Array:
        return self.nearest_points[1]


StdVec_Contact = typed_list("StdVec_Contact", instances(Contact), __name__)
StdVec_CollisionRequest = typed_list("StdVec_CollisionRequest", instances(CollisionRequest), __name__)
StdVec_CollisionResult = typed_list("StdVec_CollisionResult", instances(CollisionResult), __name__)
StdVec_DistanceRequest = typed_list("StdVec_DistanceRequest", instances(DistanceRequest), __name__)
StdVec_DistanceResult = typed_list("StdVec_DistanceResult", instances(DistanceResult), __name__)


def check(
    state: SceneState,
    pair: int,
    request: CollisionRequest,
    result: CollisionResult,
    o1: Optional[CollisionGeometry],
    o2: CollisionGeometry,
) -> bool:
    """Fills `result` for a pair of a SceneState whose volumes are placed; returns whether it collides."""
    result.clear()
    if request.security_margin == -math.inf:
        return False
    needs_distance = request.security_margin != 0 or request.enable_distance_lower_bound
    distance = state.distance(pair) if needs_distance else None
    if distance is not None:
        result.distance_lower_bound = distance[0]
    collides = state.collides(pair) if request.security_margin == 0 else distance[0] <= request.security_margin
    if not collides:
        return False
    contacts = state.contacts(pair)[: request.num_max_contacts] if request.enable_contact else []
    for position, normal, depth in contacts:
        result.addContact(Contact(o1, o2, position, normal, -depth))
    if not contacts and request.enable_contact:
        gap, a, b, normal = distance or state.distance(pair)
        result.addContact(Contact(o1, o2, 0.5 * (a + b), normal, gap))
    elif not contacts:
        result.addContact(Contact(o1, o2))
    if result.distance_lower_bound == math.inf:
        result.distance_lower_bound = min(c.penetration_depth for c in result.getContacts()) if request.enable_contact else -math.inf
    return True


def measure(state: SceneState, pair: int, result: DistanceResult, o1: Optional[CollisionGeometry], o2: CollisionGeometry) -> float:
    """Fills `result` for a pair of a SceneState whose volumes are placed; returns the distance [m]."""
    result.min_distance, first, second, result.normal = state.distance(pair)
    result.nearest_points = [first, second]
    result.o1, result.o2 = o1, o2
    return result.min_distance


class _Shape:
    """A shape as a key of the cache of compiled pairs."""

    def __init__(self, shape: CollisionGeometry) -> None:
        self.shape, self.key = shape, shape._key()

    def __hash__(self) -> int:
        return hash(self.key)

    def __eq__(self, other: object) -> bool:
        return self.key == other.key


@functools.lru_cache(maxsize=64)
def _compiled(first, second):
    return Scene([first.shape._libdyn(), second.shape._libdyn()], [(0, 1)])


def _placed(o1, M1, o2, M2):
    state = SceneState(_compiled(_Shape(o1), _Shape(o2)))
    state.place([(0, SE3(M1)), (1, SE3(M2))])
    return state


def collide(
    o1: Optional[CollisionGeometry],
    M1: Union[SE3, Transform3f],
    o2: CollisionGeometry,
    M2: Union[SE3, Transform3f],
    request: CollisionRequest,
    result: CollisionResult,
) -> Any:
    """Checks shape o1 at pose M1 (SE3 or Transform3f) against o2 at M2. Fills `result`; returns the number of contacts."""
    check(_placed(o1, M1, o2, M2), 0, request, result, o1, o2)
    return result.numContacts()


def distance(
    o1: Optional[CollisionGeometry],
    M1: Union[SE3, Transform3f],
    o2: CollisionGeometry,
    M2: Union[SE3, Transform3f],
    request: DistanceRequest,
    result: DistanceResult,
) -> float:
    """Computes the distance between shape o1 at pose M1 (SE3 or Transform3f) and o2 at M2. Fills `result`; returns the distance [m]."""
    return measure(_placed(o1, M1, o2, M2), 0, result, o1, o2)
