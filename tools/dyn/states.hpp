// States from a JSON file, and results back: numbers with 17 significant digits, sizes checked, NaN and Inf refused.
#pragma once

#include <dyn/compile/compact_model.hpp>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <string>
#include <vector>

namespace dyn::tool {

struct State {
  Eigen::VectorXd q, v, a, tau;
  bool has_v = false, has_a = false, has_tau = false;
};

/// Reads {"samples":[{"q":[],"v":[],"a":[],"tau":[]}, ...]}; "-" is standard input. Vectors that a sample leaves out are zero.
/// Throws Error naming the sample's index.
std::vector<State> readStates(const std::string& path, const CompactModel& model);

/// The same, each with its entry in the file.
std::vector<std::pair<State, nlohmann::json>> readSamples(const std::string& path, const CompactModel& model);

/// Random states of a model: q within its limits, v, a in [-1, 1], tau in [-5, 5].
std::vector<State> randomStates(const CompactModel& model, int count, std::uint64_t seed);

}  // namespace dyn::tool
