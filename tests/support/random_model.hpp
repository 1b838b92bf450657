// Random trees of every joint type that is loaded, the same for the same seed.
#pragma once

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
  /// Of a body made of eight points and a ball, so it is physical.
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

/// Parameters that fit a type's schema.
inline Parameters plausibleParameters(const JointTypeInfo& info, Random& random) {
  Parameters parameters;
  for (int i = 0; i < info.parameter_count; ++i) {
    const ParameterSpec& spec = info.parameters[i];
    if (!spec.required) continue;
    const Vec3<double> x = random.vector();
    switch (spec.kind) {
      case ParameterKind::number: parameters[spec.name] = std::vector<double>{random.uniform(0.05, 0.3)}; break;
      case ParameterKind::vector3:
        parameters[spec.name] = std::string(spec.name) == "radii" ? std::vector<double>{0.1 + 0.1 * std::fabs(x.x), 0.2, 0.15} : std::vector<double>{x.x, x.y, x.z};
        break;
      case ParameterKind::numbers: parameters[spec.name] = std::vector<double>{0.3, 0.5, 0.4, -0.7}; break;
      case ParameterKind::text: parameters[spec.name] = std::string("text"); break;
      case ParameterKind::joints: {
        JointDescription first, second;
        first.type = "revolute";
        first.parameters["axis"] = std::vector<double>{x.x, x.y, 1};
        first.placement = random.pose();
        second.type = "prismatic";
        second.parameters["axis"] = std::vector<double>{1, x.z, x.y};
        second.placement = random.pose();
        parameters[spec.name] = std::vector<JointDescription>{first, second};
        break;
      }
    }
  }
  return parameters;
}

/// n moving bodies; types cycle through the registry from a random start, so that a few seeds meet them all. Some fixed joints between.
inline Model randomTree(const JointRegistry& registry, int n, std::uint64_t seed, bool losses = false) {
  Random random(seed);
  Model model;
  model.name = "random" + std::to_string(seed);
  model.gravity = random.vector(10);
  const auto& types = registry.jointTypes();
  const int start = random.below(static_cast<int>(types.size()));
  for (int i = 0; i < n; ++i) {
    JointDescription joint;
    const JointTypeInfo& info = types[static_cast<std::size_t>(start + i) % types.size()]->info();
    joint.name = "j" + std::to_string(i);
    joint.type = info.name;
    joint.parameters = plausibleParameters(info, random);
    joint.placement = random.pose();
    if (losses) {
      joint.damping.assign(max_joint_nv, random.uniform(0, 1));
      joint.friction.assign(max_joint_nv, random.uniform(0, 0.5));
      joint.armature.assign(max_joint_nv, random.uniform(0, 0.2));
    }
    model.addBody("b" + std::to_string(i), random.below(3) == 0 ? random.below(i + 1) : i, joint, random.inertia());
  }
  model.addFrame("tool", n, random.pose());
  return model;
}

}  // namespace dyn::test
