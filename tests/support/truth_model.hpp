// SPDX-License-Identifier: BSD-2-Clause
// Reads models in the JSON format of the reference data.
#pragma once

#include <dyn/model/model.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <map>

namespace dyn::test {

/// Rotation matrix from roll, pitch and yaw, computed in extended precision and rounded once.
inline Mat3<double> rollPitchYaw(long double r, long double p, long double y) {
  const long double cr = std::cos(r), sr = std::sin(r), cp = std::cos(p), sp = std::sin(p), cy = std::cos(y), sy = std::sin(y);
  const Mat3<long double> Z{{cy, -sy, 0, sy, cy, 0, 0, 0, 1}}, Y{{cp, 0, sp, 0, 1, 0, -sp, 0, cp}}, X{{1, 0, 0, 0, cr, -sr, 0, sr, cr}};
  const Mat3<long double> R = Z * Y * X;
  Mat3<double> out;
  for (int i = 0; i < 9; ++i) out.m[i] = static_cast<double>(R.m[i]);
  return out;
}

/// Reads a joint. The two custom joints of the data are formulas; example plugins with the same motion replace them.
inline JointDescription jointOf(const nlohmann::json& j, const std::string& model) {
  JointDescription joint;
  joint.name = j["name"];
  joint.type = j["type"];
  for (const char* key : {"axis", "axis2"})
    if (j.contains(key)) joint.parameters[key] = j[key].get<std::vector<double>>();
  if (j.contains("pitch")) joint.parameters["pitch"] = std::vector<double>{j["pitch"].get<double>()};
  if (joint.type == "custom") {
    joint.type = model == "custom_cam" ? "cam_follower" : "ball_screw";
    for (const auto& [name, value] : j["params"].items()) joint.parameters[name] = std::vector<double>{value.get<double>()};
  }
  if (j.contains("placement")) {
    const auto xyz = j["placement"]["xyz"].get<std::vector<double>>(), rpy = j["placement"]["rpy"].get<std::vector<double>>();
    joint.placement.p = {xyz[0], xyz[1], xyz[2]};
    joint.placement.R = rollPitchYaw(rpy[0], rpy[1], rpy[2]);
  }
  return joint;
}

inline Model readTruthModel(const nlohmann::json& document) {
  Model model;
  model.name = document["name"];
  const auto g = document["gravity"].get<std::vector<double>>();
  model.gravity = {g[0], g[1], g[2]};
  std::map<std::string, int> bodies{{"universe", 0}};
  for (const auto& j : document["joints"]) {
    const std::string name = j["name"];
    Inertia<double> Y;
    if (j.contains("mass")) {
      const auto c = j["com"].get<std::vector<double>>(), I = j["inertia"].get<std::vector<double>>();
      Y = {j["mass"].get<double>(), {c[0], c[1], c[2]}, {I[0], I[1], I[2], I[3], I[4], I[5]}};
    }
    bodies[name] = model.addBody(name + "_link", bodies.at(j.value("parent", "universe")), jointOf(j, model.name), Y);
  }
  return model;
}

}  // namespace dyn::test
