// SPDX-License-Identifier: BSD-2-Clause
// Options that say how a model moves through time: the model, the step, and what the model touches. `dyn simulate` and sweeps have them.
#pragma once

#include "model_options.hpp"
#include "volume_options.hpp"

#include <string>
#include <vector>

namespace dyn::tool {

struct MotionOptions : ModelOptions {
  std::string integrator = "rk4";
  std::vector<std::string> contacts, ground;
  VolumeOptions volumes;
  double time = 1, dt = 1e-3, tolerance = 1e-8, height = 0, friction = 0.8, restitution = 0;
  bool limits = false, touching = false;

  void add(CLI::App& app);

  SimulatorOptions simulator() const;
  ConstraintSet constraints(const CompactModel& model) const;
  /// Finds contacts with the ground, between volumes, or both; empty if the options ask for neither. Each thread needs a finder of its own.
  ContactFinder finder(const CompactModel& model, const Model& description) const;
  /// The same with volumes that were compiled before; empty unless `touching`.
  ContactFinder finder(const CompactModel& model, const std::optional<GeometryModel>& geometry) const;
};

/// Moves a state to the nearest one that the constraints allow. Throws Error(closure).
void assembleState(const CompactModel& model, const ConstraintSet& constraints, Eigen::VectorXd& q, Eigen::VectorXd& v);

}  // namespace dyn::tool
