// SPDX-License-Identifier: BSD-2-Clause
// Reads states from JSON and writes results. Numbers have 17 significant digits, sizes are checked, NaN and Inf are refused.
#pragma once

#include <dyn/compile/compact_model.hpp>
#include <dyn/model/model.hpp>
#include <dyn/spatial/motion.hpp>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

/// Results in the order in which they were inserted. Matrices are written row after row.
using Json = nlohmann::ordered_json;

inline Json flat(const double* data, std::ptrdiff_t size) { return Json(std::vector<double>(data, data + size)); }
inline Json flat(const Vec3<double>& x) { return Json{x.x, x.y, x.z}; }
inline Json flat(const Mat3<double>& R) { return flat(R.m, 9); }
inline Json flat(const Motion<double>& m) { return Json{m.linear.x, m.linear.y, m.linear.z, m.angular.x, m.angular.y, m.angular.z}; }
inline Json flat(const Eigen::Ref<const Eigen::MatrixXd>& M) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index j = 0; j < M.cols(); ++j) rows.push_back(M(i, j));
  return rows;
}

/// Throws Error(argument) if a result is not finite, since JSON cannot hold it. The message names the first such result and `of`, its owner.
void requireFinite(const Json& results, const std::string& of);

struct State {
  Eigen::VectorXd q, v, a, tau;
  bool has_v = false, has_a = false, has_tau = false;

  /// The vector with this name: q, v, a or tau.
  const Eigen::VectorXd& argument(const std::string& name) const { return name == "q" ? q : name == "v" ? v : name == "a" ? a : tau; }
};

/// Reads {"samples":[{"q":[],"v":[],"a":[],"tau":[]}, ...]}; "-" is standard input. Vectors missing in a sample are zero. Throws Error, which names
/// the sample's index.
std::vector<State> readStates(const std::string& path, const CompactModel& model);

/// Reads the same; each state comes with its JSON entry.
std::vector<std::pair<State, nlohmann::json>> readSamples(const std::string& path, const CompactModel& model);

/// Returns the state that the description calls by this name, with a = 0 and tau = 0. It has a velocity, which is 0 unless the description has one.
State namedState(const CompactModel& model, const Model& description, const std::string& name);

/// Random states of a model: q within its limits, v and a in [-1, 1], tau in [-5, 5].
std::vector<State> randomStates(const CompactModel& model, int count, std::uint64_t seed);

}  // namespace dyn::tool
