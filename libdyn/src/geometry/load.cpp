// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/load.hpp"

#include "geometry/files.hpp"
#include "number_text.hpp"

#include <cmath>
#include <cstdio>
#include <type_traits>
#include <utility>

namespace dyn {

namespace {

[[noreturn]] void refuse(const GeometryDescription& g, const std::string& why) {
  throw Error(ErrorCode::model, "geometry '" + g.name + "': " + why, g.where);
}

/// Bounds of lengths [m]. Between them the products in the search for nearest points neither overflow nor underflow.
constexpr double smallest = 1e-75, largest = 1e75;

void needPositive(const GeometryDescription& g, const char* what, double x) {
  if (!(x > 0) || !std::isfinite(x)) refuse(g, std::string("its ") + what + " is " + number(x) + ", not a positive length");
  if (x < smallest || x > largest) refuse(g, std::string("its ") + what + " is " + number(x) + " m; lengths are between 1e-75 m and 1e75 m");
}

/// The same for a length that may be zero.
void needLength(const GeometryDescription& g, const char* what, double x) {
  if (x != 0) needPositive(g, what, x);
}

bool finite(const Vec3<double>& x) { return std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z); }
bool within(const Vec3<double>& x) { return std::fabs(x.x) <= largest && std::fabs(x.y) <= largest && std::fabs(x.z) <= largest; }

void needFinite(const GeometryDescription& g, const std::vector<Vec3<double>>& points) {
  for (const Vec3<double>& x : points)
    if (!within(x)) refuse(g, "it has a point that is not finite, or more than 1e75 m away");
}

Convex convex(Core core, const Vec3<double>& half, double margin = 0) {
  Convex c;
  c.core = core;
  c.half = half;
  c.margin = margin;
  return c;
}

Volume round(const GeometryDescription& g, Core core, double radius, double length) {
  needPositive(g, "radius", radius);
  needPositive(g, "length", length);
  return Volume::solid(convex(core, {radius, radius, 0.5 * length}));
}

Volume fromTriangles(const GeometryDescription& g, const geometry::TriangleMesh& mesh, bool hull) {
  needFinite(g, mesh.vertices);
  if (mesh.triangles.empty()) refuse(g, "it has no triangles");
  for (const auto& t : mesh.triangles)
    for (const int corner : t)
      if (corner < 0 || corner >= static_cast<int>(mesh.vertices.size()))
        refuse(g, "a triangle names vertex " + std::to_string(corner) + ", which does not exist");
  if (hull || boundsConvexSolid(mesh)) return Volume::hull(hullCorners(mesh.vertices));
  return Volume::triangles(mesh.vertices, mesh.triangles);
}

Volume compiled(const GeometryDescription& g, const geometry::Sphere& s) {
  needLength(g, "radius", s.radius);
  return Volume::solid(convex(Core::point, {}, s.radius));
}
Volume compiled(const GeometryDescription& g, const geometry::Box& b) {
  for (const double side : {b.size.x, b.size.y, b.size.z}) needPositive(g, "side", side);
  return Volume::solid(convex(Core::box, 0.5 * b.size));
}
Volume compiled(const GeometryDescription& g, const geometry::Capsule& s) {
  needPositive(g, "radius", s.radius);
  needLength(g, "length", s.length);
  return Volume::solid(convex(Core::segment, {0, 0, 0.5 * s.length}, s.radius));
}
Volume compiled(const GeometryDescription& g, const geometry::Cylinder& s) { return round(g, Core::cylinder, s.radius, s.length); }
Volume compiled(const GeometryDescription& g, const geometry::Cone& s) { return round(g, Core::cone, s.radius, s.length); }
Volume compiled(const GeometryDescription& g, const geometry::HalfSpace& s) {
  const double length = norm(s.normal);
  if (!(length > 0) || !std::isfinite(length) || !std::isfinite(s.offset)) refuse(g, "its normal is zero or not finite");
  Convex c = convex(Core::half_space, (1 / length) * s.normal);
  c.offset = s.offset / length;
  return Volume::solid(c);
}
Volume compiled(const GeometryDescription& g, const geometry::ConvexHull& s) {
  needFinite(g, s.points);
  if (s.points.empty()) refuse(g, "it has no points");
  return Volume::hull(hullCorners(s.points));
}
Volume compiled(const GeometryDescription& g, const geometry::TriangleMesh& mesh) { return fromTriangles(g, mesh, false); }
Volume compiled(const GeometryDescription& g, const geometry::Voxels& s) {
  for (const auto& cube : s.cubes) {
    needPositive(g, "cube", cube.size);
    if (!finite(cube.center)) refuse(g, "it has a cube that is nowhere");
  }
  return Volume::cubes(s.cubes);
}

}  // namespace

std::string uriOf(const GeometryDescription& g) {
  if (const auto* mesh = std::get_if<geometry::MeshFile>(&g.shape)) return mesh->uri;
  if (const auto* octree = std::get_if<geometry::OctreeFile>(&g.shape)) return octree->uri;
  return "";
}

std::string VolumeLoader::pathOf(const GeometryDescription& g) const { return resolveUri(uriOf(g), packages_, g.where.file); }

bool VolumeLoader::available(const GeometryDescription& g) const { return uriOf(g).empty() || !pathOf(g).empty(); }

std::shared_ptr<const Volume> VolumeLoader::load(const GeometryDescription& g) {
  const SE3<double>& X = g.placement;
  if (!within(X.p) || !finite(X.R.row(0)) || !finite(X.R.row(1)) || !finite(X.R.row(2)))
    refuse(g, "its placement is not finite, or more than 1e75 m away");
  return std::visit(
      [&](const auto& shape) -> std::shared_ptr<const Volume> {
        using Shape = std::decay_t<decltype(shape)>;
        if constexpr (std::is_same_v<Shape, geometry::MeshFile>) {
          return fromMesh(shape, g);
        } else if constexpr (std::is_same_v<Shape, geometry::OctreeFile>) {
          return fromOctree(g);
        } else {
          return std::make_shared<const Volume>(compiled(g, shape));
        }
      },
      g.shape);
}

geometry::Voxels VolumeLoader::octree(const GeometryDescription& g) {
  geometry::Voxels cubes = readOctree(pathOf(g));
  ++octrees_;
  return cubes;
}

std::shared_ptr<const Volume> VolumeLoader::fromOctree(const GeometryDescription& g) {
  std::shared_ptr<const Volume>& known = volumes_[pathOf(g)];
  if (!known) known = std::make_shared<const Volume>(Volume::cubes(octree(g).cubes));
  return known;
}

geometry::TriangleMesh VolumeLoader::triangles(const geometry::MeshFile& file, const GeometryDescription& g) {
  if (!finite(file.scale) || file.scale.x == 0 || file.scale.y == 0 || file.scale.z == 0) refuse(g, "its scale is zero or not finite");
  const std::string path = pathOf(g);
  if (!meshes_.count(path)) meshes_.emplace(path, readMesh(path));
  geometry::TriangleMesh mesh = meshes_.at(path);
  for (Vec3<double>& x : mesh.vertices) x = {file.scale.x * x.x, file.scale.y * x.y, file.scale.z * x.z};
  // Mirroring reverses the orientation of the triangles, which is restored here.
  if (file.scale.x * file.scale.y * file.scale.z < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::shared_ptr<const Volume> VolumeLoader::fromMesh(const geometry::MeshFile& file, const GeometryDescription& g) {
  char scale[160];
  std::snprintf(scale, sizeof scale, "|%a %a %a %d", file.scale.x, file.scale.y, file.scale.z, file.convex ? 1 : 0);
  std::shared_ptr<const Volume>& known = volumes_[pathOf(g) + scale];
  if (!known) known = std::make_shared<const Volume>(fromTriangles(g, triangles(file, g), file.convex));
  return known;
}

}  // namespace dyn
