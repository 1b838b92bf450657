#include "truth.hpp"

#include "errors.hpp"

#include <dyn/error.hpp>

#include <limits>

namespace dyn::tool {

namespace {

struct Quantity {
  const char *algorithm, *key, *scale;
};
constexpr Quantity quantities[] = {{"rnea", "rnea", "rnea_scale"},
                                   {"nle", "nle", "rnea_scale"},
                                   {"gravity", "gravity", "rnea_scale"},
                                   {"aba", "aba", "aba_scale"},
                                   {"forward_dynamics_cholesky", "aba", "aba_scale"},
                                   {"crba", "M", nullptr}};

const Quantity* find(const std::string& algorithm) {
  for (const Quantity& quantity : quantities)
    if (algorithm == quantity.algorithm) return &quantity;
  return nullptr;
}

}  // namespace

std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model) {
  std::vector<TruthSample> out;
  for (const auto& [state, entry] : readSamples(path, model)) {
    if (!entry.contains("truth") || !entry["truth"].is_object())
      throw Error(ErrorCode::syntax, "sample " + std::to_string(out.size()) + " has no truth", {path, 0, ""});
    TruthSample sample{state, {}};
    for (const Quantity& quantity : quantities)
      for (const char* key : {quantity.key, quantity.scale})
        if (key != nullptr && entry["truth"].contains(key)) sample.truth[key] = flatten(entry["truth"][key]);
    out.push_back(std::move(sample));
  }
  return out;
}

void replaceTruth(TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers) {
  const Quantity* quantity = find(algorithm);
  if (quantity != nullptr && sample.truth.contains(quantity->key)) sample.truth[quantity->key].assign(numbers.begin(), numbers.end());
}

double truthError(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u) {
  const Quantity* quantity = find(algorithm);
  const auto truthOf = [&](const char* key) {
    const auto found = sample.truth.find(key);
    return found == sample.truth.end() ? std::vector<long double>() : found->second;
  };
  if (quantity == nullptr || truthOf(quantity->key).empty()) return std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> x(numbers.begin(), numbers.end());
  return quantity->scale == nullptr ? relativeError(x, truthOf(quantity->key), u)
                                    : scaledError(x, truthOf(quantity->key), truthOf(quantity->scale), u);
}

}  // namespace dyn::tool
