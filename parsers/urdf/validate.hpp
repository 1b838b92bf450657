// SPDX-License-Identifier: BSD-2-Clause
// Checks a file for errors that urdfdom lets pass. The README of this folder lists them.
#pragma once

#include "document.hpp"

#include <dyn/parsers/urdf.hpp>

#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::urdf {

/// The file's links and joints, by name and in the file's order. They are checked: names are unique, joints name links that exist, the links form one
/// tree, numbers are finite, axes have a direction, masses and inertias are those of bodies, and chains of mimics end at a joint that mimics none.
struct Outline {
  std::vector<const tinyxml2::XMLElement*> links, joints;  ///< in the file's order
  std::unordered_map<std::string, const tinyxml2::XMLElement*> link, joint;
  std::unordered_map<std::string, std::vector<const tinyxml2::XMLElement*>> joints_below;  ///< by parent link, in the file's order
  std::string root;
};

/// Adds every Error(syntax | model) found, with file and line, to `errors`; the outline is usable only if there are none. Adds notes to the document.
Outline validate(const Document& document, const Options& options, std::vector<Error>& errors);

/// Returns the link that a joint's <parent> or <child> (`which`) names. Throws Error(model) if the element is missing.
std::string linkOf(const Document& document, const tinyxml2::XMLElement& joint, const char* which);

}  // namespace dyn::urdf
