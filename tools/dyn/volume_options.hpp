// Which volumes a command looks at: those of the robot, those around it, and which pairs of them.
#pragma once

#include "model_options.hpp"

#include <dyn/geometry/geometry_model.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

struct VolumeOptions {
  std::string scene, srdf;
  std::vector<std::string> packages;
  bool skip_missing = false;

  void add(CLI::App& app);
  /// The robot with the scene around it.
  Model description(const ModelOptions& robot) const;
  GeometryOptions geometry() const;
};

}  // namespace dyn::tool
