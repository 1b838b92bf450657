// SPDX-License-Identifier: BSD-2-Clause
// The part of a study that varies: states, gravity, bodies, joints, controls and options of each sample.
#pragma once

#include "distribution.hpp"
#include "states.hpp"

#include <optional>

namespace dyn::tool::sweep {

/// The values of one sample.
struct Inputs {
  Eigen::VectorXd q, v, a, tau;    ///< neutral and zero, unless they vary
  Eigen::VectorXd target, kp, kd;  ///< of the controller, likewise
  std::vector<double> values;      ///< of all quantities, one after another; q with its nq coordinates
  std::uint64_t sample = 0;        ///< number of the sample
};

/// One quantity that varies.
struct Quantity {
  enum class Kind { q, v, a, tau, target, kp, kd, gravity, mass, com, damping, friction, armature, lower, upper, velocity, effort, option, value };
  /// Some of the numbers, with a distribution of their own.
  struct Part {
    int first = 0;
    Distribution distribution;
    std::int64_t stride = 1;  ///< samples for which its cell stays the same, in a row
  };
  std::string name;  ///< such as q or bodies.hand.mass
  Kind kind{};
  int target = 0;  ///< number of the body in the description, or of the joint's body
  int size = 0;    ///< numbers among Inputs::values
  std::vector<Part> parts;
  bool limits = false;       ///< q, target: uniform within the model's limits, rotations uniform over their group
  bool coordinates = false;  ///< q, target: the parts are coordinates (nq), not displacements from neutral (nv)

  bool isConfiguration() const { return kind == Kind::q || kind == Kind::target; }
  bool isLimit() const { return kind >= Kind::lower && kind <= Kind::effort; }
};

class Variation {
 public:
  /// Reads the member "vary". Throws Error(syntax | argument), which names the member.
  Variation(const Study& study, const Model& description, const CompactModel& model);

  const std::vector<Quantity>& quantities() const { return quantities_; }
  /// Entries of all lists times points of all grids. Sample k takes cell k modulo this number; the quantity whose name comes last varies fastest.
  std::int64_t cells() const { return cells_; }
  bool changesModel() const { return changes_model_; }
  /// Whether the samples' models differ in inertias only.
  bool changesInertiasOnly() const { return changes_model_ && !changes_others_; }
  bool changesLimits() const { return changes_limits_; }
  /// Whether joint torques are given, as numbers or by a controller.
  bool controls() const { return controls_; }
  bool changesOptions() const { return changes_options_; }

  Inputs draw(std::uint64_t sample) const;
  /// Puts a sample's values into the options, and returns the numbers of the description that they change. Throws Error(argument) for a value out of
  /// its range.
  ModelNumbers apply(const Inputs& inputs, const Model& description, MotionOptions& options) const;
  /// Puts a sample's limits of joints into the description. Throws Error(argument) for a value out of its range.
  void applyLimits(const Inputs& inputs, Model& description) const;
  /// The values by name.
  Json json(const Inputs& inputs) const;

 private:
  void add(Quantity quantity);
  void readState(const json::Value& value, Quantity::Kind kind, const std::string& name, const Model& description);
  void readBodies(const json::Value& value, const Model& description);
  void readValues(const json::Value& value);
  void readController(const json::Value& value, const Model& description);
  void readJoints(const json::Value& value, const Model& description, const Study& study);
  void placeCells();

  CompactModel model_;
  std::uint64_t seed_;
  std::vector<Quantity> quantities_;
  std::int64_t cells_ = 1;
  bool changes_model_ = false, changes_options_ = false, changes_others_ = false, changes_limits_ = false, controls_ = false;
};

}  // namespace dyn::tool::sweep
