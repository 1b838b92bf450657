// SPDX-License-Identifier: BSD-2-Clause
#include "condition.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace dyn::tool {

namespace {

constexpr double bad = 1e12;

double conditionAt(const CompactModel& model, const Eigen::VectorXd& q) {
  Data data(model, Need::derivatives);
  try {
    crba(model, data, q);
    if (!model.follows()) cholesky::decompose(model, data);
    return conditionOfMassMatrix(model, data);
  } catch (const Error& e) {
    if (e.code() != ErrorCode::singular) throw;
    return std::numeric_limits<double>::infinity();
  }
}

}  // namespace

std::string warningOfCondition(const CompactModel& model, const Eigen::VectorXd& q) {
  const double condition = conditionAt(model, q);
  if (condition < bad) return "";
  const int digits = std::isfinite(condition) ? std::max(0, static_cast<int>(16 - std::log10(condition))) : 0;
  char text[256];
  std::snprintf(text, sizeof text,
                "the mass matrix is nearly singular (condition %.1e): of accelerations, M^-1 and their derivatives %d digits are right", condition,
                digits);
  return text;
}

}  // namespace dyn::tool
