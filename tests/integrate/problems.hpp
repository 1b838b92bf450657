// SPDX-License-Identifier: BSD-2-Clause
// Accurate states of reference motions, read from the shared data.
#pragma once

#include "support/mechanisms.hpp"

#include <string>
#include <vector>

namespace dyn::test {

struct State {
  double time = 0;
  Vector q, v;
};

/// States of the torque-free body or the heavy top at the reference's times, the first at t = 0.
inline std::vector<State> rigidReference(const std::string& which) {
  const nlohmann::json all = readJson(sharedFolder() + "/truth/data/ref_rigid.json")[which];
  std::vector<State> out{{0, numbers(all.contains("quat0") ? all["quat0"] : all["q0"]), numbers(all["omega0"])}};
  for (const auto& s : all["states"]) out.push_back({number(s["t"]), numbers(s["quat_xyzw"]), numbers(s["omega"])});
  return out;
}

/// States of the double pendulum that starts at rest, at (0.5, 0.25) or, if `chaotic`, at (2, 0.5).
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

inline double largest(const Vector& x) { return x.cwiseAbs().maxCoeff(); }

/// Simulates from `start` to the time of `end`. Returns the largest difference of the configuration from that of `end`.
inline double errorAt(const CompactModel& model, const SimulatorOptions& options, const State& start, const State& end) {
  Simulator simulator(model, options);
  simulator.reset(start.q, start.v, start.time);
  simulator.advance(end.time);
  return difference(model, end.q, simulator.q()).cwiseAbs().maxCoeff();
}

}  // namespace dyn::test
