#include "truth.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace dyn::tool {

namespace {

void flatten(const nlohmann::json& x, std::vector<long double>& out) {
  if (x.is_array()) {
    for (const nlohmann::json& entry : x) flatten(entry, out);
  } else if (x.is_string()) {
    out.push_back(std::strtold(x.get<std::string>().c_str(), nullptr));
  } else {
    out.push_back(static_cast<long double>(x.get<double>()));
  }
}

struct Quantity {
  const char *algorithm, *key, *scale;
};
constexpr Quantity quantities[] = {{"rnea", "rnea", "rnea_scale"},
                                   {"nle", "nle", "rnea_scale"},
                                   {"gravity", "gravity", "rnea_scale"},
                                   {"aba", "aba", "aba_scale"},
                                   {"crba", "M", nullptr}};

}  // namespace

std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model) {
  const std::vector<State> states = readStates(path, model);
  std::vector<TruthSample> out;
  std::ifstream file(path);
  const nlohmann::json document = nlohmann::json::parse(file, nullptr, false);
  for (const State& state : states) {
    TruthSample sample{state, {}};
    const nlohmann::json& entry = document["samples"][out.size()];
    if (!entry.contains("truth") || !entry["truth"].is_object())
      throw Error(ErrorCode::syntax, "sample " + std::to_string(out.size()) + " has no truth", {path, 0, ""});
    for (const Quantity& quantity : quantities)
      for (const char* key : {quantity.key, quantity.scale})
        if (key != nullptr && entry["truth"].contains(key) && !sample.truth.contains(key)) flatten(entry["truth"][key], sample.truth[key]);
    out.push_back(std::move(sample));
  }
  return out;
}

double truthError(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double unit_roundoff) {
  for (const Quantity& quantity : quantities) {
    if (algorithm != quantity.algorithm) continue;
    const auto truth = sample.truth.find(quantity.key);
    const auto scale = quantity.scale ? sample.truth.find(quantity.scale) : sample.truth.end();
    const auto size = static_cast<std::size_t>(numbers.size());
    if (truth == sample.truth.end() || truth->second.size() != size) break;
    if (quantity.scale && (scale == sample.truth.end() || scale->second.size() != size)) break;
    long double magnitude = 0, worst = 0;
    for (const long double x : truth->second) magnitude = std::max(magnitude, std::fabs(x));
    for (std::size_t i = 0; i < size; ++i) {
      const long double off = std::fabs(static_cast<long double>(numbers[static_cast<Eigen::Index>(i)]) - truth->second[i]);
      const long double yardstick = quantity.scale ? scale->second[i] : magnitude;
      if (!(off == 0)) worst = std::max(worst, yardstick > 0 ? off / yardstick : std::numeric_limits<long double>::infinity());
    }
    return static_cast<double>(worst / static_cast<long double>(unit_roundoff));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace dyn::tool
