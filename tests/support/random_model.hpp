// SPDX-License-Identifier: BSD-2-Clause
// Random trees of all loaded joint types. Equal seeds give equal trees.
#pragma once

#include "support/catch.hpp"

#include <dyn/conformance/conformance.hpp>
#include <dyn/dyn.hpp>
#include <dyn/lie/se3.hpp>

#include <random>
#include <string>

namespace dyn::test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : generator_(seed) {}
  double uniform(double a = -1, double b = 1) { return a + (b - a) * (static_cast<double>(generator_() >> 11) * 0x1p-53); }
  int below(int n) { return static_cast<int>(generator_() % static_cast<std::uint64_t>(n)); }
  Vec3<double> vector(double bound = 1) { return {uniform(-bound, bound), uniform(-bound, bound), uniform(-bound, bound)}; }
  Eigen::VectorXd vector(Eigen::Index n, double bound) {
    Eigen::VectorXd x(n);
    for (double& e : x) e = uniform(-bound, bound);
    return x;
  }
  SE3<double> pose() { return {exp3(vector(2)), vector(0.5)}; }
  /// The inertia of a ball and eight points, so it is physically consistent.
  Inertia<double> inertia() {
    Inertia<double> Y{uniform(0.1, 0.5), vector(0.2), {}};
    const double r = uniform(0.05, 0.2);
    const double I = 0.4 * Y.mass * r * r;
    Y.rotational = {I, 0, 0, I, 0, I};
    for (int i = 0; i < 8; ++i) {
      const double m = uniform(0.05, 0.3);
      Y = Y + Inertia<double>{m, vector(0.3), {}};
    }
    return Y;
  }

 private:
  std::mt19937_64 generator_;
};

inline int degreesOfFreedom(const JointDescription& joint, const JointRegistry& registry) {
  Model alone;
  alone.addBody("body", 0, joint);
  return compile(alone, registry).nv();
}

/// A tree of n bodies. Joint types, "fixed" included, cycle through the registry from a random start, so a few seeds cover all types. With `losses`
/// joints have damping, friction and armature.
inline Model randomTree(const JointRegistry& registry, int n, std::uint64_t seed, bool losses = false) {
  Random random(seed);
  Model model;
  model.name = "random" + std::to_string(seed);
  model.gravity = random.vector(10);
  const auto& types = registry.jointTypes();
  if (types.empty()) registry.jointType("revolute");  // throws and says why there are no types
  const int start = random.below(static_cast<int>(types.size()));
  for (int i = 0; i < n; ++i) {
    JointDescription joint;
    const JointTypeInfo& info = types[static_cast<std::size_t>(start + i) % types.size()]->info();
    joint.name = "j" + std::to_string(i);
    joint.type = info.name;
    joint.parameters = exampleParameters(info, seed + static_cast<std::uint64_t>(i));
    joint.placement = random.pose();
    if (losses) {
      const auto nv = static_cast<std::size_t>(degreesOfFreedom(joint, registry));
      joint.damping.assign(nv, random.uniform(0, 1));
      joint.friction.assign(nv, random.uniform(0, 0.5));
      joint.armature.assign(nv, random.uniform(0, 0.2));
    }
    // A statement of its own, because compilers evaluate arguments in any order, and trees must not depend on the compiler.
    const Inertia<double> inertia = random.inertia();
    model.addBody("b" + std::to_string(i), random.below(3) == 0 ? random.below(i + 1) : i, joint, inertia);
  }
  model.addFrame("tool", n, random.pose());
  return model;
}

/// Adds a dependent revolute joint, "follower" + number, with the body "followed" + number. It depends on the model's last revolute joint, or on a
/// new joint "master" if the model has none.
inline void addDependent(Model& model, const std::string& number = "", const std::vector<double>& coefficients = {0.1, 2}) {
  JointDescription dependent;
  dependent.name = "follower" + number;
  dependent.type = "revolute";
  dependent.parameters["axis"] = std::vector<double>{0, 1, 0};
  std::string master;
  for (const BodyDescription& b : model.bodies)
    if (b.joint.type == "revolute") master = b.joint.name;
  if (master.empty()) {
    JointDescription joint;
    joint.name = master = "master";
    joint.type = "revolute";
    joint.parameters = dependent.parameters;
    model.addBody("turned", 2, joint, Random(8).inertia());
  }
  dependent.coupling = {"mimic", master, {{"coefficients", coefficients}}};
  model.addBody("followed" + number, 3, dependent, Random(9).inertia());
}

/// A tree of n bodies, each on a random earlier one. Joint types come from the list in turn. All joints have armature and damping.
inline Model treeOf(const JointRegistry& registry, const std::vector<std::string>& types, int n, std::uint64_t seed) {
  Random random(seed);
  Model model;
  model.gravity = random.vector(10);
  for (int i = 0; i < n; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = types[static_cast<std::size_t>(i) % types.size()];
    joint.parameters = exampleParameters(registry.jointType(joint.type, {}).info(), seed + static_cast<std::uint64_t>(i));
    joint.placement = random.pose();
    joint.armature.assign(static_cast<std::size_t>(degreesOfFreedom(joint, registry)), 0.05);
    joint.damping.assign(joint.armature.size(), 0.3);
    const Inertia<double> inertia = random.inertia();
    model.addBody("b" + std::to_string(i), i == 0 ? 0 : random.below(i) + 1, joint, inertia);
  }
  return model;
}

}  // namespace dyn::test
