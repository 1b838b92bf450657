// A link's <collision> and <visual> elements.
#pragma once

#include "document.hpp"

#include <dyn/model/geometry_description.hpp>

#include <vector>

namespace dyn::urdf {

/// Volumes of a link, on body `body`: collisions are called <link>_0, <link>_1, ..., visuals <link>_visual_0, ... Beside URDF's sphere, box,
/// cylinder and mesh: capsule, cone, plane (a half-space) and octree. <collision_checking> turns cylinders that it names into capsules and
/// meshes into their hulls. An element without a shape is a note. Throws Error(syntax) for numbers that are none.
std::vector<GeometryDescription> readGeometries(const Document& document, const tinyxml2::XMLElement& link, int body);

}  // namespace dyn::urdf
