// SPDX-License-Identifier: BSD-2-Clause
// Volumes as geoms, and the meshes that they name.
#pragma once

#include "masks.hpp"
#include "xml/output.hpp"

#include <dyn/model/model.hpp>

#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>

namespace dyn::mjcf {

class Volumes {
 public:
  Volumes(const Model& model, xml::Output& out) : model_(model), out_(out), masks_(model) {}
  /// Writes <asset> with all meshes; none if there are no meshes.
  void writeAssets();
  /// Writes <geom>, if MJCF has the shape. `fixed` says whether the volume cannot move: MuJoCo has planes only there.
  void write(const GeometryDescription& g, bool fixed);
  /// Whether contype and conaffinity say which volumes are not checked.
  bool saysPairs() const { return masks_.complete(); }

 private:
  std::string assetOf(const GeometryDescription& g);

  const Model& model_;
  xml::Output& out_;
  const Masks masks_;
  std::size_t meshes_ = 0;                                                        ///< that are written
  std::unordered_map<const GeometryDescription*, std::string> asset_;             ///< the meshes of volumes
  std::map<std::tuple<std::string, double, double, double>, std::string> files_;  ///< the meshes of files and scales
  std::set<std::string> names_;                                                   ///< of geoms
};

}  // namespace dyn::mjcf
