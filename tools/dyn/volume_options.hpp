// SPDX-License-Identifier: BSD-2-Clause
// Options that choose the volumes of a command: the robot's, those around it, and the pairs to check.
#pragma once

#include "model_options.hpp"

#include <dyn/geometry/geometry_model.hpp>

#include <optional>
#include <string>
#include <vector>

namespace dyn::tool {

/// Adds the option --package.
CLI::Option* addPackages(CLI::App& app, std::vector<std::string>& packages);

struct VolumeOptions {
  std::string scene;
  std::vector<std::string> packages;
  bool skip_missing = false;
  std::string narrow = "own";
  std::optional<double> fcl_tolerance;

  void add(CLI::App& app);
  /// The robot with the scene around it.
  Model description(const ModelOptions& robot) const;
  GeometryOptions geometry() const;
};

}  // namespace dyn::tool
