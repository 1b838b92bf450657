// SPDX-License-Identifier: BSD-2-Clause
#include "volumes.hpp"

#include "common/reader.hpp"
#include "joints.hpp"

#include <dyn/lie/so3.hpp>
#include <dyn_sdk/joint_plugin.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace dyn::mjcf {

namespace {

using Numbers = std::vector<double>;

/// Whether MuJoCo reads files of that ending.
bool hasReader(const std::string& path) {
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending == ".stl" || ending == ".obj" || ending == ".msh";
}

/// Type, sizes and place of a shape in MJCF.
struct Shaped {
  std::string type;  ///< empty: MJCF does not have it
  Numbers size;
  SE3<double> pose;  ///< of the geom in the volume's frame
  std::string loss;  ///< why there is no type
};

struct Shapes {
  bool fixed;
  Shaped operator()(const geometry::Sphere& s) const {
    if (s.radius == 0) return {"", {}, {}, "points, which are spheres without radius"};
    return {"sphere", {s.radius}, {}, ""};
  }
  Shaped operator()(const geometry::Box& s) const { return {"box", {s.size.x / 2, s.size.y / 2, s.size.z / 2}, {}, ""}; }
  Shaped operator()(const geometry::Capsule& s) const {
    if (s.length == 0) return {"sphere", {s.radius}, {}, ""};
    return {"capsule", {s.radius, s.length / 2}, {}, ""};
  }
  Shaped operator()(const geometry::Cylinder& s) const { return {"cylinder", {s.radius, s.length / 2}, {}, ""}; }
  Shaped operator()(const geometry::Cone&) const { return {"", {}, {}, "cones"}; }
  Shaped operator()(const geometry::HalfSpace& s) const {
    if (!fixed) return {"", {}, {}, "half-spaces on bodies that move"};
    Vec3<long double> n;
    const double xyz[] = {s.normal.x, s.normal.y, s.normal.z};
    if (!sdk::unitVector(xyz, n)) return {"", {}, {}, "half-spaces without a normal"};
    const Vec3<long double> normal = cast<long double>(s.normal);
    const SE3<double> pose{n.x == 0 && n.y == 0 && n.z == 1 ? Mat3<double>::identity() : sdk::frameWithZ(n),
                           cast<double>((s.offset / std::sqrt(dot(normal, normal))) * n)};
    return {"plane", {0, 0, 1}, pose, ""};  // endless, with a grid of 1 m in pictures
  }
  Shaped operator()(const geometry::ConvexHull& s) const { return points(s.points.size()); }
  Shaped operator()(const geometry::TriangleMesh& s) const { return points(s.vertices.size()); }
  Shaped operator()(const geometry::MeshFile& s) const {
    if (s.uri.find("://") != std::string::npos && !s.uri.starts_with("file://"))
      return {"", {}, {}, "meshes that package:// or model:// names, which MuJoCo does not resolve"};
    if (!hasReader(s.uri)) return {"", {}, {}, "meshes of files that are neither STL, OBJ nor MSH"};
    return {"mesh", {}, {}, ""};
  }
  Shaped operator()(const geometry::Voxels&) const { return {"", {}, {}, "voxels"}; }
  Shaped operator()(const geometry::OctreeFile&) const { return {"", {}, {}, "octrees"}; }

 private:
  static Shaped points(std::size_t count) {
    if (count < 4) return {"", {}, {}, "meshes of fewer than four points"};
    return {"mesh", {}, {}, ""};
  }
};

}  // namespace

void Volumes::writeAssets() {
  for (const GeometryDescription& g : model_.geometries)
    if (std::visit(Shapes{true}, g.shape).type == "mesh") asset_.emplace(&g, assetOf(g));
  if (meshes_ > 0) out_.close();
}

std::string Volumes::assetOf(const GeometryDescription& g) {
  const auto begin = [&](const std::string& name) {
    if (meshes_++ == 0) out_.open("asset");
    out_.open("mesh");
    out_.put("name", name);
  };
  const auto numbers = [](const std::vector<Vec3<double>>& points) {
    Numbers out;
    for (const Vec3<double>& p : points) out.insert(out.end(), {p.x, p.y, p.z});
    return out;
  };
  std::string name = "mesh_" + std::to_string(meshes_);
  const auto* file = std::get_if<geometry::MeshFile>(&g.shape);
  if (file == nullptr) {
    begin(name);
    if (const auto* hull = std::get_if<geometry::ConvexHull>(&g.shape)) {
      out_.put("vertex", numbers(hull->points));
    } else {
      const auto& mesh = std::get<geometry::TriangleMesh>(g.shape);
      out_.put("vertex", numbers(mesh.vertices));
      Numbers faces;
      for (const auto& t : mesh.triangles) faces.insert(faces.end(), t.begin(), t.end());
      if (!faces.empty()) out_.put("face", faces);
    }
    out_.close();
    return name;
  }
  const std::string path = file->uri.starts_with("file://") ? file->uri.substr(7) : file->uri;
  const Vec3<double>& s = file->scale;
  const auto [known, is_new] = files_.emplace(std::tuple(path, s.x, s.y, s.z), name);
  if (!is_new) return known->second;
  out_.loseFolder(path, g.where.file);
  begin(name);
  out_.put("file", path);
  if (s.x != 1 || s.y != 1 || s.z != 1) out_.put("scale", s);
  out_.close();
  return name;
}

void Volumes::write(const GeometryDescription& g, bool fixed) {
  const Shaped shape = std::visit(Shapes{fixed}, g.shape);
  if (shape.type.empty()) {
    out_.lose("volumes: " + shape.loss, g.name);
    return;
  }
  const bool visual = g.role == GeometryDescription::Role::visual;
  const auto* file = std::get_if<geometry::MeshFile>(&g.shape);
  if (file && file->convex == visual) out_.lose("whether a mesh is its surface or its convex hull: MuJoCo sees surfaces and collides hulls", g.name);
  if (!visual && std::holds_alternative<geometry::TriangleMesh>(g.shape)) out_.lose("surfaces that collide, which become their convex hulls", g.name);
  const std::string name = g.name.empty() ? "" : reader::freeName(g.name, names_);
  if (name != g.name) out_.lose("names of volumes that several have", g.name);
  out_.open("geom");
  if (!name.empty()) out_.put("name", name);
  out_.put("type", shape.type);
  if (!shape.size.empty()) out_.put("size", shape.size);
  if (shape.type == "mesh") out_.put("mesh", asset_.at(&g));
  putPose(out_, g.placement * shape.pose);
  const auto [type, affinity] = visual ? std::pair(0, 0) : masks_.of(g);
  if (type != 1) out_.put("contype", std::to_string(type));
  if (affinity != 1) out_.put("conaffinity", std::to_string(affinity));
  out_.close();
}

}  // namespace dyn::mjcf
