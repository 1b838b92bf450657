// SPDX-License-Identifier: BSD-2-Clause
// Volumes on bodies and in the world, as a parser or a user's program describes them. Lengths are in metres, in the geometry's own frame.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/se3.hpp>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

namespace geometry {

/// The solids from sphere to cone are centred at the origin of their frame.
struct Sphere {
  double radius = 0;  ///< 0: a point
};
struct Box {
  Vec3<double> size;  ///< along x, y, z
};
struct Capsule {
  double radius = 0, length = 0;  ///< `length` is that of the segment on z between the centres of the two round ends
};
struct Cylinder {
  double radius = 0, length = 0;  ///< along z
};
struct Cone {
  double radius = 0, length = 0;  ///< the base is at z = -length / 2, the tip at +length / 2
};
/// All points x with normal . x <= offset.
struct HalfSpace {
  Vec3<double> normal{0, 0, 1};
  double offset = 0;
};
/// The convex hull of points.
struct ConvexHull {
  std::vector<Vec3<double>> points;
};
/// A mesh of triangles. It collides as a surface, so a body inside that does not touch it does not collide. A mesh whose triangles bound a convex
/// solid collides as that solid.
struct TriangleMesh {
  std::vector<Vec3<double>> vertices;
  std::vector<std::array<int, 3>> triangles;
};
/// A mesh in a file. compileGeometry() reads it if a pair needs it. The uri is a path, "file://", "package://" or "model://".
struct MeshFile {
  std::string uri;
  Vec3<double> scale{1, 1, 1};
  bool convex = false;  ///< use the mesh's convex hull
};
/// Cubes, such as the occupied leaves of an octree.
struct Voxels {
  struct Cube {
    Vec3<double> center;
    double size = 0;
  };
  std::vector<Cube> cubes;
};
/// The occupied leaves of an octomap file (.bt or .ot).
struct OctreeFile {
  std::string uri;
};

}  // namespace geometry

using GeometryShape = std::variant<geometry::Sphere, geometry::Box, geometry::Capsule, geometry::Cylinder, geometry::Cone, geometry::HalfSpace,
                                   geometry::ConvexHull, geometry::TriangleMesh, geometry::MeshFile, geometry::Voxels, geometry::OctreeFile>;

/// Makes a mesh from a height field: heights[i * columns + j] is the height at (x0 + i dx, y0 + j dy). Throws Error(size) unless there are
/// rows * columns heights, and at least two rows and two columns.
DYN_API geometry::TriangleMesh heightField(int rows, int columns, const std::vector<double>& heights, double x0, double y0, double dx, double dy);

/// A volume fixed to a body.
struct GeometryDescription {
  enum class Role { collision, visual };
  std::string name{};
  int body = 0;             ///< 0: the world
  SE3<double> placement{};  ///< pose in the body's frame
  GeometryShape shape{};
  Role role = Role::collision;
  Where where{};
};

/// Names of two bodies or volumes that are not checked against each other, and the reason.
struct DisabledCollision {
  std::string body{}, other{};
  std::string reason{};
};

}  // namespace dyn
