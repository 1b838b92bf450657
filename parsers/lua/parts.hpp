// SPDX-License-Identifier: BSD-2-Clause
// The parts of RBDL's format that are not bodies and joints.
#pragma once

#include "table.hpp"

#include <dyn/model/model.hpp>
#include <dyn/parsers/lua.hpp>

#include <map>
#include <string>
#include <vector>

namespace dyn::lua {

/// The things that names stand for in constraints: bodies, and frames given by `points` and `local_frames`.
struct Names {
  std::map<std::string, int> bodies;  ///< index in Model::bodies; "ROOT" is the world
  std::map<std::string, FrameDescription> points, frames;

  /// Return what a value names. Throw Error(model) for a name that does not exist, with similar ones.
  /// @{
  int body(const Value& name) const;
  const FrameDescription& frame(const Value& name, const std::map<std::string, FrameDescription>& among, const char* what) const;
  /// @}
};

/// Reads the volumes of one entry of `frames`, for a body that has no index yet. A mesh whose size only its file tells is noted and left out.
std::vector<GeometryDescription> readVisuals(const Value& visuals, const std::string& body);

/// Reads the constraint sets, in the order of their names. `model` has the bodies.
std::vector<NamedConstraints> readConstraintSets(const Value& sets, const Model& model, const Names& names);

}  // namespace dyn::lua
