// SPDX-License-Identifier: BSD-2-Clause
#include "truth.hpp"

#include "errors.hpp"

#include <dyn/error.hpp>

#include <limits>

namespace dyn::tool {

namespace {

struct Quantity {
  const char* algorithm;
  std::vector<const char*> keys;
  const char* scale;
};

const std::vector<Quantity>& quantities() {
  static const std::vector<Quantity> all{{"rnea", {"rnea"}, "rnea_scale"},
                                         {"nle", {"nle"}, "rnea_scale"},
                                         {"gravity", {"gravity"}, "rnea_scale"},
                                         {"aba", {"aba"}, "aba_scale"},
                                         {"forward_dynamics_cholesky", {"aba"}, "aba_scale"},
                                         {"crba", {"M"}, nullptr},
                                         {"minverse", {"Minv"}, nullptr},
                                         {"rnea_derivatives", {"dtau_dq", "dtau_dv"}, nullptr},
                                         {"aba_derivatives", {"ddq_dq", "ddq_dv"}, nullptr}};
  return all;
}

const Quantity* find(const std::string& algorithm) {
  for (const Quantity& quantity : quantities())
    if (algorithm == quantity.algorithm) return &quantity;
  return nullptr;
}

/// Calls f(truth, first) for each matrix of the algorithm, up to the first one without a truth in the sample. The algorithm's numbers for the matrix
/// begin at `first`.
template <class Sample, class F>
void eachTruth(const std::string& algorithm, Sample& sample, F&& f) {
  const Quantity* quantity = find(algorithm);
  if (quantity == nullptr) return;
  Eigen::Index first = 0;
  for (const char* key : quantity->keys) {
    const auto found = sample.truth.find(key);
    if (found == sample.truth.end()) return;
    f(found->second, first);
    first += static_cast<Eigen::Index>(found->second.size());
  }
}

/// The place among an algorithm's numbers of number k of a truth: truths are row after row, results column after column.
Eigen::Index placeOf(Eigen::Index k, Eigen::Index count, Eigen::Index n) { return count == n * n ? (k % n) * n + k / n : k; }

}  // namespace

const char* truthKey(const std::string& algorithm) {
  const Quantity* quantity = find(algorithm);
  return quantity ? quantity->keys.front() : nullptr;
}

std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model) {
  std::vector<TruthSample> out;
  for (const auto& [state, entry] : readSamples(path, model)) {
    if (!entry.contains("truth") || !entry["truth"].is_object())
      throw Error(ErrorCode::syntax, "sample " + std::to_string(out.size()) + " has no truth", {path, 0, ""});
    TruthSample sample{state, {}};
    for (const Quantity& quantity : quantities()) {
      std::vector<const char*> keys = quantity.keys;
      if (quantity.scale) keys.push_back(quantity.scale);
      for (const char* key : keys)
        if (entry["truth"].contains(key)) sample.truth[key] = flatten(entry["truth"][key]);
    }
    out.push_back(std::move(sample));
  }
  return out;
}

void replaceTruth(TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers) {
  const Eigen::Index n = sample.state.v.size();
  eachTruth(algorithm, sample, [&](std::vector<long double>& truth, Eigen::Index first) {
    const auto count = static_cast<Eigen::Index>(truth.size());
    for (Eigen::Index k = 0; k < count; ++k) truth[static_cast<std::size_t>(k)] = numbers[first + placeOf(k, count, n)];
  });
}

void addErrors(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u, ErrorSummary& out) {
  const Quantity* quantity = find(algorithm);
  if (quantity == nullptr) return;
  const std::vector<long double>* scale = quantity->scale && sample.truth.contains(quantity->scale) ? &sample.truth.at(quantity->scale) : nullptr;
  if (quantity->scale && !scale) return;
  const Eigen::Index n = sample.state.v.size();
  eachTruth(algorithm, sample, [&](const std::vector<long double>& truth, Eigen::Index first) {
    const auto count = static_cast<Eigen::Index>(truth.size());
    const bool fits = first + count <= numbers.size();
    long double largest = 0;
    for (const long double x : truth) largest = std::max(largest, std::abs(x));
    for (Eigen::Index k = 0; k < count; ++k) {
      const double x = fits ? numbers[first + placeOf(k, count, n)] : std::numeric_limits<double>::quiet_NaN();
      const long double off = std::abs(static_cast<long double>(x) - truth[static_cast<std::size_t>(k)]);
      const long double by = scale ? (*scale)[static_cast<std::size_t>(k)] : largest;
      out.add(!std::isfinite(x) ? std::numeric_limits<double>::infinity()
              : off == 0        ? 0.0
                                : static_cast<double>(off / by / static_cast<long double>(u)));
    }
  });
}

}  // namespace dyn::tool
