// What a program wants of a scene, so that the compiler can leave out the rest.
#pragma once

#include <dyn/model/model.hpp>

#include <string>
#include <vector>

namespace dyn {

struct Scene {
  /// Joints, bodies or frames whose motion is wanted; empty: all of them, and nothing is left out. A name that a body or frame and a joint
  /// share is the body's or frame's.
  std::vector<std::string> outputs{};
  /// Bodies or frames that may touch each other while the scene moves: where one is wanted all are needed.
  std::vector<std::string> touching{};
  /// Whether motion follows from forces; otherwise positions and velocities are given, and only what carries an output matters.
  bool dynamics = true;
};

/// The model without what cannot influence the outputs: islands, trees that neither constraints, couplings nor contacts tie to one with an
/// output; without dynamics all bodies that carry none; and frames that nothing speaks of. What stays moves as it would in the whole, up to
/// rounding: all joints together decide which of them share lanes, and so the order of sums. `report` gets a line that says what was left out.
/// Throws Error(model) for a name that is not there.
DYN_API Model keepForScene(const Model& model, const Scene& scene, std::vector<std::string>& report);

/// The trees on the world that move independently of each other: for each its first body. Contacts between bodies of `touching` tie
/// trees together as constraints and couplings do.
DYN_API std::vector<std::string> islandsOf(const Model& model, const std::vector<std::string>& touching = {});

}  // namespace dyn
