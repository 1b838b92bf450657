// Motions whose course is known: small mechanisms made here, and references read from the shared data.
#pragma once

#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace dyn::test {

using Vector = Eigen::VectorXd;

/// Unit point masses at the ends of unit rods, angles relative, hanging along -z.
inline Model pendulum(int rods) {
  Model model;
  model.name = "pendulum";
  int parent = 0;
  for (int k = 0; k < rods; ++k) {
    JointDescription joint;
    joint.name = "j" + std::to_string(k + 1);
    joint.type = "revolute";
    joint.parameters["axis"] = std::vector<double>{0, 1, 0};
    if (k > 0) joint.placement.p = {0, 0, -1};
    parent = model.addBody("rod" + std::to_string(k + 1), parent, joint, {1, {0, 0, -1}, {}});
  }
  return model;
}

/// One body on a joint of this type, its principal moments of inertia about the joint's origin.
inline Model body(const std::string& type, double mass, const Vec3<double>& com, const Vec3<double>& moments_about_com, double gravity) {
  Model model;
  model.name = "body";
  model.gravity = {0, 0, -gravity};
  JointDescription joint;
  joint.name = "joint";
  joint.type = type;
  model.addBody("body", 0, joint, {mass, com, {moments_about_com.x, 0, 0, moments_about_com.y, 0, moments_about_com.z}});
  return model;
}

/// Turns about its intermediate axis (Dzhanibekov): moments 1, 2, 3, no gravity.
inline Model freeBody() { return body("spherical", 1, {}, {1, 2, 3}, 0); }
/// Spinning top on its tip: mass and length 1, moments 2, 2, 0.5 about the tip.
inline Model heavyTop() { return body("spherical", 1, {0, 0, 1}, {1, 1, 0.5}, 9.81); }

struct State {
  double time = 0;
  Vector q, v;
};

inline double number(const nlohmann::json& x) { return x.is_string() ? std::stod(x.get<std::string>()) : x.get<double>(); }
inline Vector numbers(const nlohmann::json& x) {
  Vector out(static_cast<Eigen::Index>(x.size()));
  for (std::size_t k = 0; k < x.size(); ++k) out[static_cast<Eigen::Index>(k)] = number(x[k]);
  return out;
}

/// Torque-free body or heavy top: states at the reference's times, the first at 0.
inline std::vector<State> rigidReference(const std::string& which) {
  const nlohmann::json all = readJson(sharedFolder() + "/truth/data/ref_rigid.json")[which];
  std::vector<State> out{{0, numbers(all.contains("quat0") ? all["quat0"] : all["q0"]), numbers(all["omega0"])}};
  for (const auto& s : all["states"]) out.push_back({number(s["t"]), numbers(s["quat_xyzw"]), numbers(s["omega"])});
  return out;
}

/// Double pendulum from rest at (0.5, 0.25), or, chaotic, at (2, 0.5).
inline std::vector<State> pendulumReference(bool chaotic) {
  std::vector<State> out;
  const nlohmann::json all = readJson(sharedFolder() + "/truth/data/ref_pendula.json")["double_pendulum"];
  for (const auto& s : all) {
    const Vector q0 = numbers(s["q0"]);
    if ((q0[0] > 1) != chaotic) continue;
    if (out.empty()) out.push_back({0, q0, Vector::Zero(2)});
    out.push_back({number(s["t"]), numbers(s["q"]), numbers(s["v"])});
  }
  return out;
}

/// The end of `problem` by steps of dt: largest difference of configuration to where it should be.
inline double errorAt(const CompactModel& model, const SimulatorOptions& options, const State& start, const State& end) {
  Simulator simulator(model, options);
  simulator.reset(start.q, start.v, start.time);
  simulator.advance(end.time);
  return difference(model, end.q, simulator.q()).cwiseAbs().maxCoeff();
}

}  // namespace dyn::test
