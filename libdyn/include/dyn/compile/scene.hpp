// SPDX-License-Identifier: BSD-2-Clause
// The parts of a scene that a program wants, so that the compiler can leave out the rest.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn {

/// The wanted parts of a model. By default all is wanted.
struct Scene {
  /// Joints, bodies or frames whose motion is wanted. If empty, all are wanted, and nothing is left out. If a joint shares its name with a body or
  /// frame, the name means the body or frame.
  std::vector<std::string> outputs{};
  /// Bodies or frames that may touch each other while the scene moves. If one is wanted, all are kept.
  std::vector<std::string> touching{};
  /// True if motion follows from forces. If false, positions and velocities are given, and only bodies that carry an output matter.
  bool dynamics = true;
};

/// Returns the model without the parts that cannot influence the outputs. With dynamics these are trees that no constraint, coupling or contact ties
/// to a tree with an output. Without dynamics, all constraints are left out. A body stays only if it carries an output, or the master of a dependent
/// joint that carries one. Frames that neither the scene nor a remaining constraint names are left out, too, and so are groups and named
/// states. The rest moves as in the whole model, up to rounding: all joints together decide which of them share lanes, and so the order of sums. `report` gets a line that says what was left out.
/// Throws Error(model) for a name that does not exist.
DYN_API Model keepForScene(const Model& model, const Scene& scene, std::vector<std::string>& report);

/// Returns the islands: groups of trees on the world that move independently of each other, each named by its first body. Contacts between bodies
/// of `touching` tie trees together as constraints and couplings do. Throws Error(model) for a name that does not exist.
DYN_API std::vector<std::string> islandsOf(const Model& model, const std::vector<std::string>& touching = {});

}  // namespace dyn
