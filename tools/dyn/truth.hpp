// SPDX-License-Identifier: BSD-2-Clause
// References with more digits than a double has, and the errors of results against them.
#pragma once

#include "states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace dyn::tool {

struct TruthSample {
  State state;
  std::map<std::string, std::vector<long double>> truth;
};

/// Reads {"samples":[{"q":[],"v":[],"a":[],"tau":[],"truth":{"rnea":[],"rnea_scale":[],"nle":[],"gravity":[],"aba":[],"aba_scale":[],
/// "M":[], ...}}]}. Truths are numbers or strings of digits, and matrices are row after row; keys may be missing. Throws Error(file | syntax | size),
/// which names the file.
std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model);

/// Largest and root mean square error of many numbers, in units of roundoff. Both are NaN if there are none, and infinite if one is infinite.
class ErrorSummary {
 public:
  void add(double error) {
    most_ = std::isnan(most_) ? error : std::max(most_, error);
    squares_ += error * error;
    ++count_;
  }
  double most() const { return most_; }
  double rms() const { return std::sqrt(squares_ / static_cast<double>(count_)); }

 private:
  double most_ = std::numeric_limits<double>::quiet_NaN(), squares_ = 0;
  long count_ = 0;
};

/// The truth key of an algorithm's first matrix; null if truth files have none for it. `algorithm` is its name in dyn bench.
const char* truthKey(const std::string& algorithm);

/// Adds the errors of an algorithm's numbers against the truth, in units of u; `algorithm` is its name in dyn bench. Errors of rnea, nle, gravity and
/// aba are relative to the scales in the file, others to the largest entry of each matrix. Matrices are column after column; if an algorithm has
/// several, they follow each other. Adds nothing if the file has no such truth.
void addErrors(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u, ErrorSummary& out);

/// Replaces the truth by these numbers. For states rounded to floats, the results in doubles at the rounded states serve as truth.
void replaceTruth(TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers);

}  // namespace dyn::tool
