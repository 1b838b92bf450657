# SPDX-License-Identifier: BSD-2-Clause
"""Shapes, requests and results of collision checks, with the names of hpp-fcl (now Coal). libdyn compares the shapes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NoReturn, Optional

import numpy as np

import libdyn

from ._arrays import array
from ._queries import (
    CollisionRequest as CollisionRequest,
    CollisionRequestFlag as CollisionRequestFlag,
    CollisionResult as CollisionResult,
    Contact as Contact,
    DistanceRequest as DistanceRequest,
    DistanceResult as DistanceResult,
    StdVec_CollisionRequest as StdVec_CollisionRequest,
    StdVec_CollisionResult as StdVec_CollisionResult,
    StdVec_Contact as StdVec_Contact,
    StdVec_DistanceRequest as StdVec_DistanceRequest,
    StdVec_DistanceResult as StdVec_DistanceResult,
    collide as collide,
    distance as distance,
)
from ._transform import Transform3f as Transform3f, Transform3s as Transform3s
from .missing import Missing

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array, Path

# These are the names that Pinocchio takes from hpp-fcl. The others are hppfcl.Box, hppfcl.distance and so on.
__all__ = [
    "CachedMeshLoader",
    "CollisionGeometry",
    "CollisionResult",
    "Contact",
    "DistanceResult",
    "MeshLoader",
    "StdVec_CollisionResult",
    "StdVec_Contact",
    "StdVec_DistanceResult",
]


class CollisionGeometry:
    """A shape. Shapes are compared by class and sizes."""

    __hash__ = None
    _sizes = ()

    def _libdyn(self):
        raise NotImplementedError(f"libdyn has no shape {type(self).__name__}; use one of libdyn's shapes, such as libdyn.ConvexHull")

    def _key(self):
        return (type(self).__name__, *(getattr(self, name) for name in self._sizes))

    def computeVolume(self) -> float:
        """Returns the volume [m^3]."""
        raise NotImplementedError(f"the volume of {type(self).__name__} is not computed")

    def clone(self) -> Self:
        return type(self)(*(getattr(self, name) for name in self._sizes))

    copy = clone

    def __copy__(self) -> Self:
        return self.clone()

    def __deepcopy__(self, memo: Any) -> Self:
        return self.clone()

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), tuple(getattr(self, name) for name in self._sizes)

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, CollisionGeometry) else NotImplemented

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(repr(getattr(self, name)) for name in self._sizes)})"


class ShapeBase(CollisionGeometry):
    """A solid of a simple shape."""


class Sphere(ShapeBase):
    """A ball: radius [m]."""

    _sizes = ("radius",)

    def __init__(self, radius: float) -> None:
        self.radius = _size(radius, "radius")

    def _libdyn(self):
        return libdyn.Sphere(self.radius)

    def computeVolume(self) -> float:
        return 4 / 3 * math.pi * self.radius**3


class Box(ShapeBase):
    """A cuboid by its whole sides [m]: Box(x, y, z) or Box(array of three)."""

    def __init__(self, x: Any, y: Optional[float] = None, z: Optional[float] = None) -> None:
        self.halfSide = 0.5 * array(x if y is None else (x, y, z), (3,), "side")

    def _libdyn(self):
        return libdyn.Box(*(2.0 * self.halfSide))

    def _key(self):
        return ("Box", *self.halfSide.tolist())

    def clone(self) -> Box:
        return Box(2.0 * self.halfSide)

    def __reduce__(self) -> tuple[Any, ...]:
        return Box, (2.0 * self.halfSide,)

    def __repr__(self) -> str:
        return "Box({}, {}, {})".format(*(2.0 * self.halfSide).tolist())

    def computeVolume(self) -> float:
        return float(8.0 * np.prod(self.halfSide))


class _Round(ShapeBase):
    """A shape about z, by its radius and length [m]."""

    _sizes = ("radius", "_length")
    _shape = None

    def __init__(self, radius: float, lz: float) -> None:
        self.radius, self.halfLength = _size(radius, "radius"), 0.5 * _size(lz, "lz")

    @property
    def _length(self):
        return 2.0 * self.halfLength

    def _libdyn(self):
        return self._shape(self.radius, self._length)


class Capsule(_Round):
    """A cylinder about z with round ends: Capsule(radius, length between the centres of the ends) [m]."""

    _shape = libdyn.Capsule

    def computeVolume(self) -> float:
        return math.pi * self.radius**2 * (self._length + 4 / 3 * self.radius)


class Cylinder(_Round):
    """A cylinder about z: Cylinder(radius, length) [m]."""

    _shape = libdyn.Cylinder

    def computeVolume(self) -> float:
        return math.pi * self.radius**2 * self._length


class Cone(_Round):
    """A cone about z with its tip at +length / 2: Cone(radius, length) [m]."""

    _shape = libdyn.Cone

    def computeVolume(self) -> float:
        return math.pi * self.radius**2 * self._length / 3


class Halfspace(ShapeBase):
    """All points x with n . x <= d: Halfspace(n, d) or Halfspace(a, b, c, d)."""

    def __init__(self, *args: Any) -> None:
        if len(args) == 4:
            args = (args[:3], args[3])
        n, self.d = args if args else ((1.0, 0.0, 0.0), 0.0)
        self.n = array(n, (3,), "n").copy()
        length = np.linalg.norm(self.n)
        if not length > 0:
            raise ValueError("Halfspace: the normal is zero")
        self.n /= length
        self.d = float(self.d) / length

    def _libdyn(self):
        return libdyn.HalfSpace(self.n, self.d)

    def _key(self):
        return ("Halfspace", *self.n.tolist(), self.d)

    def clone(self) -> Halfspace:
        return Halfspace(self.n, self.d)

    def __reduce__(self) -> tuple[Any, ...]:
        return Halfspace, (self.n, self.d)

    def __repr__(self) -> str:
        return f"Halfspace({self.n.tolist()}, {self.d})"


class Ellipsoid(ShapeBase):
    """An ellipsoid by its half axes [m]. libdyn does not compare it with others."""

    def __init__(self, x: Any, y: Optional[float] = None, z: Optional[float] = None) -> None:
        self.radii = array(x if y is None else (x, y, z), (3,), "radii").copy()

    def _key(self):
        return ("Ellipsoid", *self.radii.tolist())

    def clone(self) -> Ellipsoid:
        return Ellipsoid(self.radii)

    def __reduce__(self) -> tuple[Any, ...]:
        return Ellipsoid, (self.radii,)

    def __repr__(self) -> str:
        return f"Ellipsoid({self.radii.tolist()})"

    def computeVolume(self) -> float:
        return float(4 / 3 * math.pi * np.prod(self.radii))


class ConvexBase(ShapeBase):
    """The convex hull of points, one a row [m]."""

    def __init__(self, points: ArrayLike) -> None:
        self._points = np.array(points, dtype=float).reshape(-1, 3)

    @classmethod
    def convexHull(cls, points: ArrayLike, keepTriangles: bool = True, command: Optional[str] = None) -> Any:
        """Returns the convex hull of points."""
        return Convex(points)

    num_points = property(lambda self: len(self._points))

    def points(self, index: Optional[int] = None) -> Array:
        """Returns all points (n, 3), or one of them (3,)."""
        return self._points if index is None else self._points[index]

    def _libdyn(self):
        return libdyn.ConvexHull(self._points)

    def _key(self):
        return ("ConvexBase", self._points.tobytes())

    def clone(self) -> ConvexBase:
        return type(self)(self._points)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._points,)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.num_points} points)"


class Convex(ConvexBase):
    """The convex hull of points; triangles of its surface may be given and are not needed."""

    def __init__(self, points: ArrayLike, triangles: Optional[ArrayLike] = None) -> None:
        super().__init__(points)


class BVHModelBase(CollisionGeometry):
    """A mesh of triangles: vertices (n, 3) [m] and triangles (m, 3), or a file, which is read when a pair needs it."""

    def __init__(
        self,
        vertices: Optional[ArrayLike] = None,
        triangles: Optional[ArrayLike] = None,
        path: Optional[Path] = None,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        convex: bool = False,
    ) -> None:
        self._vertices = np.zeros((0, 3)) if vertices is None else np.array(vertices, dtype=float).reshape(-1, 3)
        self._triangles = np.zeros((0, 3), int) if triangles is None else np.array(triangles, dtype=int).reshape(-1, 3)
        self.path, self.scale, self._convex = path, array(scale, (3,), "scale").copy(), bool(convex)

    @property
    def convex(self) -> Any:
        """The convex hull as a shape of its own."""
        return self if self._convex else BVHModelOBBRSS(self._vertices, self._triangles, path=self.path, scale=self.scale, convex=True)

    def buildConvexRepresentation(self, share_memory: bool = True) -> Any:
        return self.convex

    def buildConvexHull(self, keepTriangle: bool = True, command: Optional[str] = None) -> Any:
        return self.convex

    num_vertices = property(lambda self: len(self._vertices))
    num_tris = property(lambda self: len(self._triangles))

    def vertices(self, index: Optional[int] = None) -> Array:
        """Returns the vertices (n, 3) that were given, or one of them (3,)."""
        return self._vertices if index is None else self._vertices[index]

    def beginModel(self, num_tris: int = 0, num_vertices: int = 0) -> Any:
        self._vertices, self._triangles = np.zeros((0, 3)), np.zeros((0, 3), int)
        return 0

    def addVertices(self, vertices: ArrayLike) -> Any:
        self._vertices = np.vstack([self._vertices, np.asarray(vertices, dtype=float).reshape(-1, 3)])
        return 0

    def addVertex(self, vertex: ArrayLike) -> Any:
        return self.addVertices([vertex])

    def addTriangles(self, triangles: ArrayLike) -> Any:
        self._triangles = np.vstack([self._triangles, np.asarray(triangles, dtype=int).reshape(-1, 3)])
        return 0

    def addTriangle(self, a: int, b: int, c: int) -> Any:
        """Adds a triangle with new vertices a, b, c."""
        first = len(self._vertices)
        self.addVertices([a, b, c])
        return self.addTriangles([[first, first + 1, first + 2]])

    def endModel(self) -> Any:
        return 0

    def _libdyn(self):
        if self.path is not None:
            return libdyn.MeshFile(self.path, self.scale, self._convex)
        if self._convex:
            return libdyn.ConvexHull(self._vertices)
        return libdyn.TriangleMesh(self._vertices, self._triangles.tolist())

    def _key(self):
        return ("BVHModel", self.path, *self.scale.tolist(), self._convex, self._vertices.tobytes(), self._triangles.tobytes())

    def clone(self) -> BVHModelBase:
        return type(self)(self._vertices, self._triangles, self.path, self.scale, self._convex)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._vertices, self._triangles, self.path, self.scale, self._convex)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.path or f'{self.num_tris} triangles'})"


class BVHModelOBBRSS(BVHModelBase):
    """A mesh of triangles. The name is hpp-fcl's; libdyn has its own bounding volumes."""


class MeshLoader:
    """Reads meshes from files. A missing file is reported by load(); other problems where the mesh is first needed."""

    def __init__(self, node_type: Any = None) -> None:
        pass

    def load(self, filename: Path, scale: ArrayLike = (1.0, 1.0, 1.0)) -> BVHModelOBBRSS:
        """Returns the mesh of a file. Raises ValueError if the file does not exist."""
        try:
            open(filename, "rb").close()
        except OSError as error:
            raise ValueError(f"mesh file {filename}: {error.strerror}") from None
        return BVHModelOBBRSS(path=str(filename), scale=scale)


CachedMeshLoader = MeshLoader


def _size(x, name):
    x = float(x)
    if not x >= 0:
        raise ValueError(f"{name} is {x}; it must not be negative")
    return x


_WAYS = {
    "Plane": "use a Halfspace",
    "TriangleP": "use a BVHModelOBBRSS of one triangle",
    "HeightFieldAABB": "use a BVHModelOBBRSS of the surface's triangles",
    "HeightFieldOBBRSS": "use a BVHModelOBBRSS of the surface's triangles",
    "OcTree": "libdyn compares octrees in C++ (dyn::geometry::OctreeFile)",
    "DynamicAABBTreeCollisionManager": "libdyn.any_collision sorts volumes by their bounding boxes itself",
}


def __getattr__(name: str) -> NoReturn:
    if name in _WAYS:
        raise Missing(f"libdyn.pinocchio.hppfcl has no {name}: {_WAYS[name]}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
