// SPDX-License-Identifier: BSD-2-Clause
// Errors in units of roundoff u, against references with more digits than a double has.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace dyn::tool {

constexpr long double unit_roundoff = 0x1p-53L;  ///< of doubles

/// Appends the numbers and numeric strings of x, nested or not, in their order.
inline void flatten(const nlohmann::json& x, std::vector<long double>& out) {
  if (x.is_array()) {
    for (const auto& entry : x) flatten(entry, out);
  } else if (x.is_string()) {
    out.push_back(std::strtold(x.get<std::string>().c_str(), nullptr));
  } else {
    out.push_back(static_cast<long double>(x.get<double>()));
  }
}
inline std::vector<long double> flatten(const nlohmann::json& x) {
  std::vector<long double> out;
  flatten(x, out);
  return out;
}

/// Row-major entries of a matrix or vector.
inline std::vector<double> rowMajor(const Eigen::Ref<const Eigen::MatrixXd>& M) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    for (Eigen::Index j = 0; j < M.cols(); ++j) out.push_back(M(i, j));
  return out;
}

constexpr double no_match = std::numeric_limits<double>::infinity();

/// max |x - x*| / max |x*|, in u. Infinite for NaN or sizes that differ.
inline double relativeError(const std::vector<double>& x, const std::vector<long double>& truth, long double u = unit_roundoff) {
  if (x.size() != truth.size()) return no_match;
  long double worst = 0, magnitude = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) return no_match;
    worst = std::max(worst, std::fabs(static_cast<long double>(x[i]) - truth[i]));
    magnitude = std::max(magnitude, std::fabs(truth[i]));
  }
  if (worst == 0) return 0;
  return magnitude == 0 ? no_match : static_cast<double>(worst / magnitude / u);
}

/// max_k |x_k - x*_k| / scale_k, in u. Infinite for NaN or sizes that differ.
inline double scaledError(const std::vector<double>& x, const std::vector<long double>& truth, const std::vector<long double>& scale,
                          long double u = unit_roundoff) {
  if (x.size() != truth.size() || x.size() != scale.size()) return no_match;
  long double worst = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!std::isfinite(x[i])) return no_match;
    const long double e = std::fabs(static_cast<long double>(x[i]) - truth[i]);
    if (e > 0) worst = std::max(worst, scale[i] > 0 ? e / scale[i] : std::numeric_limits<long double>::infinity());
  }
  return static_cast<double>(worst / u);
}

}  // namespace dyn::tool
