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

/// Of a truth's number k among an algorithm's: truths are row after row, results column after column.
Eigen::Index placeOf(Eigen::Index k, Eigen::Index count, Eigen::Index n) { return count == n * n ? (k % n) * n + k / n : k; }

}  // namespace

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
  const Quantity* quantity = find(algorithm);
  if (quantity == nullptr) return;
  const Eigen::Index n = sample.state.v.size();
  Eigen::Index first = 0;
  for (const char* key : quantity->keys) {
    const auto found = sample.truth.find(key);
    if (found == sample.truth.end()) return;
    const auto count = static_cast<Eigen::Index>(found->second.size());
    for (Eigen::Index k = 0; k < count; ++k) found->second[static_cast<std::size_t>(k)] = numbers[first + placeOf(k, count, n)];
    first += count;
  }
}

void addErrors(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u, ErrorSummary& out) {
  const Quantity* quantity = find(algorithm);
  if (quantity == nullptr) return;
  const Eigen::Index n = sample.state.v.size();
  Eigen::Index first = 0;
  for (const char* key : quantity->keys) {
    const auto found = sample.truth.find(key);
    if (found == sample.truth.end()) return;
    const std::vector<long double>& truth = found->second;
    const auto count = static_cast<Eigen::Index>(truth.size());
    const bool fits = first + count <= numbers.size();
    const std::vector<long double>* scale = quantity->scale && sample.truth.contains(quantity->scale) ? &sample.truth.at(quantity->scale) : nullptr;
    if (quantity->scale && !scale) return;
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
    first += count;
  }
}

}  // namespace dyn::tool
