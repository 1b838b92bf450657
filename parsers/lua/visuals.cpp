// SPDX-License-Identifier: BSD-2-Clause
// Volumes to look at, in the format of MeshUp, RBDL's viewer.
#include "parts.hpp"

#include <dyn/lie/so3.hpp>

#include <cmath>
#include <numbers>
#include <optional>

namespace dyn::lua {

namespace {

constexpr double degree = std::numbers::pi / 180;

double positive(const Value& length) {
  const double x = length.number();
  if (!(x > 0)) length.fail("must be positive");
  return x;
}

/// Returns the shape of `geometry`, which has one entry.
std::optional<GeometryShape> shapeOf(const Value& geometry) {
  const std::vector<std::string> kinds = geometry.names();
  if (kinds.size() != 1) geometry.fail("must have one entry, the shape");
  const Value shape = geometry[kinds[0].c_str()];
  if (kinds[0] == "sphere") return geometry::Sphere{positive(shape["radius"])};
  if (kinds[0] == "box") return geometry::Box{shape["dimensions"].vector()};
  if (kinds[0] == "cylinder") return geometry::Cylinder{positive(shape["radius"]), positive(shape["length"])};
  if (kinds[0] == "capsule") return geometry::Capsule{positive(shape["radius"]), positive(shape["length"])};
  return std::nullopt;
}

/// Returns the mesh of `src`. MeshUp stretches a mesh to `dimensions`, which takes the mesh's own size.
std::optional<GeometryShape> meshOf(const Value& visual) {
  if (visual["dimensions"].exists() || visual["mesh_center"].exists()) return std::nullopt;
  geometry::MeshFile mesh;
  mesh.uri = visual["src"].text();
  const Value scale = visual["scale"];
  if (scale.isTable()) {
    mesh.scale = scale.vector();
  } else {
    const double factor = scale.number(1);
    mesh.scale = {factor, factor, factor};
  }
  return mesh;
}

SE3<double> placementOf(const Value& visual) {
  SE3<double> out;
  out.p = visual["translate"].vector(Vec3<double>{});
  if (const Value rotate = visual["rotate"]; rotate.exists()) {
    const Value axis_value = rotate["axis"];
    const Vec3<double> axis = axis_value.vector();
    const double length = std::sqrt(dot(axis, axis));
    if (!(length > 0)) axis_value.fail("has no direction");
    out.R = exp3((rotate["angle"].number() * degree / length) * axis);
  }
  return out;
}

}  // namespace

std::vector<GeometryDescription> readVisuals(const Value& visuals, const std::string& body) {
  std::vector<GeometryDescription> out;
  for (int k = 1, count = visuals.length(); k <= count; ++k) {
    const Value visual = visuals[k];
    visual.noteOthers("visual", {"name", "src", "scale", "dimensions", "mesh_center", "geometry", "translate", "rotate", "color"});
    const Value geometry = visual["geometry"];
    if (!geometry.exists() && !visual["src"].exists()) visual.fail("has neither src nor geometry");
    const std::optional<GeometryShape> shape = geometry.exists() ? shapeOf(geometry) : meshOf(visual);
    if (!shape) {
      visual.notes().add(geometry.exists() ? "left out: a visual of a shape that libdyn does not know"
                                           : "left out: a visual that is stretched to the size of its mesh (dimensions, mesh_center)",
                         visual.where().line);
      continue;
    }
    GeometryDescription volume;
    volume.name = body + "_visual_" + std::to_string(out.size());
    volume.placement = placementOf(visual);
    volume.shape = *shape;
    volume.role = GeometryDescription::Role::visual;
    volume.where = visual.where();
    out.push_back(std::move(volume));
  }
  return out;
}

}  // namespace dyn::lua
