// SPDX-License-Identifier: BSD-2-Clause
// Volumes on bodies and in the world, as a parser or a user's program describes them.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/se3.hpp>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

/// Shapes of volumes. Lengths are in metres, in the shape's own frame. Spheres, boxes, capsules, cylinders and cones are centred at its origin.
/// compileGeometry() throws Error(model) for a length that is not between 1e-75 m and 1e75 m. Only a sphere's radius and a capsule's length may be 0.
namespace geometry {

/// A ball.
struct Sphere {
  double radius = 0;  ///< 0 makes a point
};
/// A cuboid along the axes of its frame.
struct Box {
  Vec3<double> size;  ///< whole side lengths along x, y, z
};
/// A cylinder with round ends, along z.
struct Capsule {
  double radius = 0,  ///< of the cylinder and of its ends
      length = 0;     ///< between the centres of the two round ends; it may be zero
};
/// A circular cylinder along z.
struct Cylinder {
  double radius = 0,  ///< of the circle
      length = 0;     ///< between the two flat ends
};
/// A circular cone along z.
struct Cone {
  double radius = 0,  ///< of the base
      length = 0;     ///< height: the base is at z = -length / 2, the tip at +length / 2
};
/// All points x with normal . x <= offset.
struct HalfSpace {
  Vec3<double> normal{0, 0, 1};  ///< points outwards; any length but zero
  double offset = 0;             ///< distance of the plane from the origin along the normal, times the normal's length
};
/// The convex hull of points.
struct ConvexHull {
  std::vector<Vec3<double>> points;  ///< at least one
};
/// A mesh of triangles. It collides as a surface, so a body inside that does not touch it does not collide. A mesh whose triangles bound a convex
/// solid collides as that solid.
struct TriangleMesh {
  std::vector<Vec3<double>> vertices;         ///< corners of the triangles
  std::vector<std::array<int, 3>> triangles;  ///< indices in `vertices`; at least one triangle
};
/// A mesh in a file. compileGeometry() reads it if a pair needs it.
struct MeshFile {
  std::string uri;              ///< a path, "file://", "package://" or "model://"; relative paths begin in the folder of GeometryDescription::where
  Vec3<double> scale{1, 1, 1};  ///< factors along x, y, z; negative ones mirror
  bool convex = false;          ///< use the mesh's convex hull
};
/// Cubes, such as the occupied leaves of an octree.
struct Voxels {
  /// A cube along the axes of the frame.
  struct Cube {
    Vec3<double> center;  ///< its centre
    double size = 0;      ///< its side
  };
  std::vector<Cube> cubes;  ///< all of them, of any sizes
};
/// The occupied leaves of an octomap file (.bt or .ot).
struct OctreeFile {
  std::string uri;  ///< as MeshFile::uri
};

}  // namespace geometry

/// Any of the shapes.
using GeometryShape = std::variant<geometry::Sphere, geometry::Box, geometry::Capsule, geometry::Cylinder, geometry::Cone, geometry::HalfSpace,
                                   geometry::ConvexHull, geometry::TriangleMesh, geometry::MeshFile, geometry::Voxels, geometry::OctreeFile>;

/// Makes a mesh from a height field: heights[i * columns + j] is the height at (x0 + i dx, y0 + j dy). Throws Error(size) unless there are
/// rows * columns heights, and at least two rows and two columns.
DYN_API geometry::TriangleMesh heightField(int rows, int columns, const std::vector<double>& heights, double x0, double y0, double dx, double dy);

/// A volume fixed to a body.
struct GeometryDescription {
  /// A volume's purpose. compileGeometry() reads collision volumes only.
  enum class Role { collision, visual };
  std::string name{};           ///< unique among volumes for collision
  int body = 0;                 ///< index in Model::bodies; 0 is the world
  SE3<double> placement{};      ///< pose in the body's frame
  GeometryShape shape{};        ///< its shape
  Role role = Role::collision;  ///< its purpose
  Where where{};                ///< where the description was read, for messages and for relative paths
};

/// Two bodies or volumes that are not checked against each other.
struct DisabledCollision {
  std::string body{},    ///< name of a body or volume
      other{};           ///< name of another one
  std::string reason{};  ///< why, for people
};

}  // namespace dyn
