// SPDX-License-Identifier: BSD-2-Clause
// A link's <collision> and <visual> elements.
#pragma once

#include "document.hpp"

#include <dyn/model/geometry_description.hpp>

#include <vector>

namespace dyn::urdf {

/// Reads the volumes of a link, on body `body`. Collisions are called <link>_0, <link>_1, ..., visuals <link>_visual_0, ... Shapes are URDF's sphere,
/// box, cylinder and mesh, and capsule, cone, plane (a half-space) and octree. <collision_checking> turns the cylinders that it names into capsules
/// and the meshes into their hulls. An element without a known shape is left out, with a note. Throws Error(syntax) for malformed numbers.
std::vector<GeometryDescription> readGeometries(const Document& document, const tinyxml2::XMLElement& link, int body);

}  // namespace dyn::urdf
