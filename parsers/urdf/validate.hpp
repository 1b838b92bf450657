// What urdfdom lets pass and a robot must not have; see the README of this folder for the list.
#pragma once

#include "document.hpp"

#include <dyn/parsers/urdf.hpp>

#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::urdf {

/// The file's elements by name and in its order, checked: names are unique, joints name links that exist, the links form one tree,
/// every number is finite, axes have a direction, masses and inertias are those of bodies, mimics end at a joint that moves.
struct Outline {
  std::vector<const tinyxml2::XMLElement*> links, joints;  ///< in the file's order
  std::unordered_map<std::string, const tinyxml2::XMLElement*> link, joint;
  std::unordered_map<std::string, std::vector<const tinyxml2::XMLElement*>> joints_below;  ///< by parent link, in the file's order
  std::string root;
};

/// Every Error(syntax | model) found, with file and line, goes into `errors`; the outline is usable only if there are none. Notes go into
/// the document.
Outline validate(const Document& document, Inertias inertias, std::vector<Error>& errors);

/// Name of the link that a joint's <parent> or <child> gives.
std::string linkOf(const Document& document, const tinyxml2::XMLElement& joint, const char* which);

}  // namespace dyn::urdf
