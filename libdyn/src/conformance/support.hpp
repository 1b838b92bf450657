// SPDX-License-Identifier: BSD-2-Clause
// Shared by the conformance checks: random numbers, finite differences, and the worst error of a check.
#pragma once

#include <dyn/conformance/conformance.hpp>

#include <Eigen/Core>

#include <cmath>
#include <limits>
#include <random>

namespace dyn::conformance {

using Findings = std::vector<ConformanceFinding>;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  Eigen::VectorXd vector(Eigen::Index size, double magnitude) {
    Eigen::VectorXd x(size);
    for (double& entry : x) entry = uniform(-magnitude, magnitude);
    return x;
  }
  Vec3<double> direction() {
    while (true) {
      const Vec3<double> x{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      const double n = std::sqrt(dot(x, x));
      if (n > 0.1 && n < 1) return {x.x / n, x.y / n, x.z / n};
    }
  }

 private:
  std::mt19937_64 engine_;
};

inline ConformanceFinding failure(const std::string& check, const std::string& why) {
  return {check, false, std::numeric_limits<double>::infinity(), 0, why};
}

/// Runs a group of checks. An exception becomes a finding.
template <class Group>
void guarded(const char* name, Findings& findings, const Group& group) {
  try {
    group();
  } catch (const std::exception& e) {
    findings.push_back(failure(name, e.what()));
  } catch (...) {
    findings.push_back(failure(name, "threw something that is no exception of the standard library"));
  }
}

/// Collects the worst error of one check over many samples, as one finding.
class Worst {
 public:
  Worst(std::string check, double bound) : finding_{std::move(check), true, 0, bound, ""} {}
  /// An error that is not a finite number counts as infinite.
  void add(double error, const std::string& where) {
    if (!(error <= std::numeric_limits<double>::max())) error = std::numeric_limits<double>::infinity();
    if (error <= finding_.error) return;
    finding_.error = error;
    finding_.detail = where;
  }
  /// Adds the error |a - b| / max(1, |b|), where |.| is the largest entry.
  void compare(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, const std::string& where) {
    if (a.size() == 0 && b.size() == 0) return;
    add(a.allFinite() && b.allFinite() ? (a - b).cwiseAbs().maxCoeff() / std::max(1.0, b.cwiseAbs().maxCoeff())
                                       : std::numeric_limits<double>::infinity(),
        where);
  }
  void into(Findings& findings) {
    finding_.passed = finding_.error <= finding_.bound;
    findings.push_back(finding_);
  }

 private:
  ConformanceFinding finding_;
};

/// Returns df/dh at h = 0 by central differences, extrapolated once. Truncation is O(h^4), rounding about 1e-12 of f.
template <class F>
auto derivativeAtZero(const F& f) {
  constexpr double h = 1e-3;
  const Eigen::VectorXd wide = (f(h) - f(-h)) / (2 * h), narrow = (f(h / 2) - f(-h / 2)) / h;
  return Eigen::VectorXd((4 * narrow - wide) / 3);
}

/// "q = (0.1, 0.2)"
std::string show(const char* name, const Eigen::VectorXd& x);

}  // namespace dyn::conformance
