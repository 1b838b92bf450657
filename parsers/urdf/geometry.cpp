// SPDX-License-Identifier: BSD-2-Clause
#include "geometry.hpp"

#include "extension.hpp"

#include <cstring>
#include <optional>
#include <string>

namespace dyn::urdf {

namespace {

using tinyxml2::XMLElement;
using namespace dyn::geometry;

/// Whether <collision_checking> names the collision `name` in an element <what>.
bool asked(const XMLElement& link, const char* what, const char* name) {
  if (name == nullptr) return false;
  for (const XMLElement* block = link.FirstChildElement("collision_checking"); block; block = block->NextSiblingElement("collision_checking"))
    for (const XMLElement* e = block->FirstChildElement(what); e; e = e->NextSiblingElement(what))
      if (e->Attribute("name") && std::strcmp(e->Attribute("name"), name) == 0) return true;
  return false;
}

std::optional<GeometryShape> readShape(const Document& d, const XMLElement& link, const XMLElement& e, const XMLElement& shape) {
  const std::string kind = shape.Name();
  const auto number = [&](const char* attribute) { return d.number(shape, attribute); };
  const char* name = e.Attribute("name");
  if (kind == "sphere") return Sphere{number("radius")};
  if (kind == "box") return Box{d.vector3(shape, "size")};
  if (kind == "cylinder") {
    if (asked(link, "capsule", name)) return Capsule{number("radius"), number("length")};
    return Cylinder{number("radius"), number("length")};
  }
  if (kind == "capsule") return Capsule{number("radius"), number("length")};
  if (kind == "cone") return Cone{number("radius"), number("length")};
  if (kind == "plane") return HalfSpace{shape.Attribute("normal") ? d.vector3(shape, "normal") : Vec3<double>{0, 0, 1}, d.number(shape, "offset", 0)};
  if (kind == "octree") return OctreeFile{d.text(shape, "filename")};
  if (kind == "mesh") {
    MeshFile mesh;
    mesh.uri = d.text(shape, "filename");
    if (shape.Attribute("scale")) mesh.scale = d.vector3(shape, "scale");
    mesh.convex = asked(link, "convex", name);
    return mesh;
  }
  return std::nullopt;
}

}  // namespace

std::vector<GeometryDescription> readGeometries(const Document& document, const XMLElement& link, int body) {
  std::vector<GeometryDescription> out;
  const std::string name = link.Attribute("name");
  for (const auto& [tag, role, prefix] :
       {std::tuple{"collision", GeometryDescription::Role::collision, "_"}, std::tuple{"visual", GeometryDescription::Role::visual, "_visual_"}}) {
    int count = 0;
    for (const XMLElement* e = link.FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) {
      const XMLElement* block = e->FirstChildElement("geometry");
      const XMLElement* shape = block ? block->FirstChildElement() : nullptr;
      const std::optional<GeometryShape> read = shape ? readShape(document, link, *e, *shape) : std::nullopt;
      if (!read) {
        document.notes().push_back("line " + std::to_string(e->GetLineNum()) + ": <" + tag + "> of link '" + name + "' " +
                                   (shape ? std::string("has an unknown shape <") + shape->Name() + ">" : "has no shape") + " and is left out");
        continue;
      }
      GeometryDescription g;
      g.name = name + prefix + std::to_string(count++);
      g.body = body;
      if (const XMLElement* origin = e->FirstChildElement("origin")) g.placement = poseOf(document, *origin);
      g.shape = *read;
      g.role = role;
      g.where = document.where(*e);
      out.push_back(std::move(g));
    }
  }
  return out;
}

}  // namespace dyn::urdf
