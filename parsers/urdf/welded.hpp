// SPDX-License-Identifier: BSD-2-Clause
// Inertias of links, and of the rigid bodies that fixed joints make of them.
#pragma once

#include "validate.hpp"

#include <dyn/spatial/inertia.hpp>

#include <string>
#include <unordered_map>
#include <vector>

namespace dyn::urdf {

/// Returns the inertia of a link in its own axes, rotated in extended precision and rounded once; zero without <inertial>.
Inertia<double> inertiaOf(const Document& document, const tinyxml2::XMLElement& link);

/// The rigid bodies of a robot: links that fixed joints hold together.
class WeldedBodies {
 public:
  /// Sums the inertias of the links of each rigid body, in the frame of its first link. O(n). Throws as inertiaOf() and poseOf().
  WeldedBodies(const Document& document, const Outline& outline);
  /// Whether the rigid body of this link has an inertia that is positive semi-definite.
  bool isPhysical(const std::string& link) const;
  /// The number of links that the rigid body of this link consists of.
  int links(const std::string& link) const { return bodies_[of_.at(link)].links; }

 private:
  struct Body {
    Inertia<long double> inertia;
    int links = 0;
  };
  std::vector<Body> bodies_;
  std::unordered_map<std::string, std::size_t> of_;  ///< link -> index of its body
};

}  // namespace dyn::urdf
