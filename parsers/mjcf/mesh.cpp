// SPDX-License-Identifier: BSD-2-Clause
#include "mesh.hpp"

#include <dyn/lie/so3.hpp>
#include <dyn/near_names.hpp>

#include <cmath>
#include <filesystem>

namespace dyn::mjcf {

namespace {

using Vector = Vec3<long double>;

/// A triangle's corners, centre, and its normal with the length of twice its area.
struct Triangle {
  Triangle(const geometry::TriangleMesh& mesh, const std::array<int, 3>& corners, const Vector& origin) {
    for (std::size_t k = 0; k < 3; ++k) x[k] = cast<long double>(mesh.vertices[static_cast<std::size_t>(corners[k])]) - origin;
    center = (1 / 3.0L) * (x[0] + x[1] + x[2]);
    normal = cross(x[1] - x[0], x[2] - x[0]);
    area = std::sqrt(dot(normal, normal)) / 2;
  }
  /// The volume of the pyramid from the origin, or the area.
  long double measure(MeshInertia how) const {
    if (how == MeshInertia::shell) return area;
    const long double volume = dot(center, normal) / 6;
    return how == MeshInertia::legacy ? std::fabs(volume) : volume;
  }
  Vector x[3], center, normal;
  long double area = 0;
};

}  // namespace

Inertia<long double> massProperties(const geometry::TriangleMesh& mesh, MeshInertia how) {
  // The pyramids' tip is the centre of the surface, so that all of them count positively in a convex mesh.
  Vector tip;
  long double area = 0;
  for (const auto& corners : mesh.triangles) {
    const Triangle t(mesh, corners, {});
    area += t.area;
    tip += t.area * t.center;
  }
  if (!(area > 0)) return {};
  tip = (1 / area) * tip;
  Inertia<long double> out;
  Vector moment;
  for (const auto& corners : mesh.triangles) {
    const Triangle t(mesh, corners, tip);
    const long double part = t.measure(how);
    out.mass += part;
    moment += (part * (how == MeshInertia::shell ? 1 : 0.75L)) * t.center;
  }
  if (!(out.mass > 0)) return {};
  out.com = tip + (1 / out.mass) * moment;
  // Second moments of pyramids, or of triangles, with their tip at the centre of mass.
  Sym3<long double> P;
  out.mass = 0;
  for (const auto& corners : mesh.triangles) {
    const Triangle t(mesh, corners, out.com);
    const long double part = t.measure(how), weight = part / (how == MeshInertia::shell ? 12 : 20);
    out.mass += part;
    const Vector sum = t.x[0] + t.x[1] + t.x[2];
    // The sum of x_i x_j^T over all pairs of corners, equal ones twice, is sum sum^T + the sum of x_i x_i^T.
    for (const Vector& x : {sum, t.x[0], t.x[1], t.x[2]})
      P += weight * Sym3<long double>{x.x * x.x, x.x * x.y, x.x * x.z, x.y * x.y, x.y * x.z, x.z * x.z};
  }
  out.rotational = {P.yy + P.zz, -P.xy, -P.xz, P.xx + P.zz, -P.yz, P.xx + P.yy};
  return out;
}

void Meshes::add(const Values& v) {
  Mesh mesh;
  mesh.element = &v.element();
  std::string file = v.text("file");
  std::string name = v.text("name");
  if (name.empty()) name = std::filesystem::path(file).stem().string();
  if (name.empty()) v.fail("<mesh> has neither a name nor a file");
  if (!file.empty()) {
    if (settings_.strip_path) file = std::filesystem::path(file).filename().string();
    mesh.file = (std::filesystem::path(settings_.mesh_folder) / file).lexically_normal().string();
  }
  if (v.has("vertex")) {
    const std::vector<double> x = v.numbers("vertex", 12, std::size_t(-1));
    if (x.size() % 3 != 0) v.fail(v.described() + ": vertex must have three numbers for each vertex", ErrorCode::syntax);
    for (std::size_t i = 0; i < x.size(); i += 3) mesh.written.vertices.push_back({x[i], x[i + 1], x[i + 2]});
  }
  if (v.has("face")) {
    const std::vector<double> f = v.numbers("face", 3, std::size_t(-1));
    if (f.size() % 3 != 0) v.fail(v.described() + ": face must have three numbers for each triangle", ErrorCode::syntax);
    for (const double x : f)
      if (x != std::floor(x) || x < 0 || x >= static_cast<double>(mesh.written.vertices.size()))
        v.fail(v.described() + ": face has a number that is no vertex's index; they begin at 0");
    for (std::size_t i = 0; i < f.size(); i += 3)
      mesh.written.triangles.push_back({static_cast<int>(f[i]), static_cast<int>(f[i + 1]), static_cast<int>(f[i + 2])});
  }
  mesh.scale = cast<double>(v.vector3("scale", {1, 1, 1}));
  mesh.refpos = cast<double>(v.vector3("refpos"));
  if (v.has("refquat")) {
    const std::vector<double> q = v.numbers("refquat", 4, 4);
    const Quaternion<double> turn{q[1], q[2], q[3], q[0]};
    if (!(std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3])) > 1e-150)) v.fail(v.described() + ": its refquat is zero");
    mesh.turned = q[1] != 0 || q[2] != 0 || q[3] != 0;
    mesh.refturn = turn.matrix();
  }
  mesh.inertia = static_cast<MeshInertia>(v.word("inertia", {"convex", "exact", "legacy", "shell"},
                                                 static_cast<int>(settings_.exact_mesh_inertia ? MeshInertia::exact : MeshInertia::legacy)));
  if (const auto [first, is_new] = meshes_.emplace(name, std::move(mesh)); !is_new)
    v.fail("two meshes are called '" + name + "'; the other is at line " + std::to_string(first->second.element->GetLineNum()));
}

const Mesh& Meshes::find(const std::string& name, const XMLElement& user) const {
  const auto found = meshes_.find(name);
  if (found != meshes_.end()) return found->second;
  std::vector<std::string> names;
  for (const auto& [known, mesh] : meshes_) names.push_back(known);
  s_.fail(user, "there is no mesh '" + name + "'" + nearNames(name, names));
}

Vec3<double> Meshes::placed(const Mesh& mesh, const Vec3<double>& x) {
  const Vec3<double> r = transposeTimes(mesh.refturn, x - mesh.refpos);
  return {mesh.scale.x * r.x, mesh.scale.y * r.y, mesh.scale.z * r.z};
}

std::optional<GeometryShape> Meshes::shape(const Mesh& mesh, bool collision, const std::string& beside, SE3<long double>& pose) const {
  pose = {};
  if (mesh.file.empty()) {
    geometry::TriangleMesh placed_mesh = mesh.written;
    for (Vec3<double>& x : placed_mesh.vertices) x = placed(mesh, x);
    if (placed_mesh.vertices.empty()) return std::nullopt;
    if (collision || placed_mesh.triangles.empty()) return geometry::ConvexHull{std::move(placed_mesh.vertices)};
    return placed_mesh;
  }
  const bool even = mesh.scale.x == mesh.scale.y && mesh.scale.x == mesh.scale.z;
  if (mesh.turned && !even) return std::nullopt;
  // placed(x) = scale R^T (x - refpos), and a MeshFile's vertices are scale x.
  pose = {cast<long double>(transpose(mesh.refturn)), cast<long double>(placed(mesh, {}))};
  namespace fs = std::filesystem;
  fs::path uri = fs::path(s_.folder()) / mesh.file;
  if (const fs::path seen = uri.lexically_relative(fs::path(beside).parent_path()); !mesh.file.starts_with('/') && !seen.empty()) uri = seen;
  return geometry::MeshFile{uri.string(), mesh.scale, collision};
}

const Inertia<long double>& Meshes::mass(const Mesh& mesh, MeshInertia how) {
  const auto known = mass_.find({&mesh, how});
  if (known != mass_.end()) return known->second;
  const XMLElement& e = *mesh.element;
  if (how == MeshInertia::convex)
    s_.fail(e, "the mass of a mesh's convex hull is not computed; write inertia=\"exact\", or give the body an <inertial>");
  geometry::TriangleMesh triangles = mesh.written;
  if (!mesh.file.empty()) {
    const std::string path = (std::filesystem::path(s_.folder()) / mesh.file).string();
    s_.checkAllowed(e, path);
    triangles = readTriangles(path);
  }
  if (triangles.triangles.empty()) s_.fail(e, "the mass of a mesh without faces is not computed; write its faces, or give the body an <inertial>");
  for (Vec3<double>& x : triangles.vertices) x = placed(mesh, x);
  // A mirrored mesh shows its inside.
  if (mesh.scale.x * mesh.scale.y * mesh.scale.z < 0)
    for (auto& t : triangles.triangles) std::swap(t[1], t[2]);
  const Inertia<long double> unit = massProperties(triangles, how);
  if (!(unit.mass > 1e-15L))
    s_.fail(e, "the mesh has no volume, or its triangles show their insides; inertia=\"shell\" gives it the mass of its surface");
  return mass_.emplace(std::pair{&mesh, how}, unit).first->second;
}

}  // namespace dyn::mjcf
