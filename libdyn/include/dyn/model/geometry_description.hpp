// Volumes on bodies and in the world, as a parser or a user's program describes them. Lengths in metres, in the geometry's own frame.
#pragma once

#include <dyn/error.hpp>
#include <dyn/spatial/se3.hpp>

#include <array>
#include <string>
#include <variant>
#include <vector>

namespace dyn {

namespace geometry {

/// Solids, centred at the origin of their frame.
struct Sphere {
  double radius = 0;  ///< 0: a point
};
struct Box {
  Vec3<double> size;  ///< along x, y, z
};
struct Capsule {
  double radius = 0, length = 0;  ///< length of the segment on z between the centres of its two ends
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
/// A surface of triangles: what lies inside without touching it does not collide. Where the triangles bound a convex solid it is that solid.
struct TriangleMesh {
  std::vector<Vec3<double>> vertices;
  std::vector<std::array<int, 3>> triangles;
};
/// A mesh in a file, read when geometry that needs it is compiled. The uri is a path, "file://" or "package://".
struct MeshFile {
  std::string uri;
  Vec3<double> scale{1, 1, 1};
  bool convex = false;  ///< take its convex hull
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

/// A height field as a mesh: heights[i * columns + j] at (x0 + i dx, y0 + j dy). Throws Error(size) unless there are rows * columns heights
/// and two of either at least.
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

/// Two bodies, or volumes by name, that are not to be checked against each other, and why.
struct DisabledCollision {
  std::string body{}, other{};
  std::string reason{};
};

}  // namespace dyn
