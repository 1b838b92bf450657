// References of more digits than a double has, and how far results are from them.
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
/// "M":[], ...}}]}: truths are numbers or strings of digits, matrices row after row; keys may be missing. Throws Error(file | syntax | size)
/// naming the file.
std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model);

/// Errors of many numbers, in units of roundoff. Both are NaN without any, infinite if one is not finite.
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

/// The key of an algorithm's first matrix, by its name in dyn bench; null where truths have none of it.
const char* truthKey(const std::string& algorithm);

/// Adds how far the numbers that `algorithm` (by its name in dyn bench) gave are from the truth, in units of u: by the scales that the
/// file gives for rnea, nle, gravity and aba, by the largest entry of each matrix for the others. Matrices are column after column; one after the
/// other where the algorithm gives several. Nothing where the file has no such truth.
void addErrors(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u, ErrorSummary& out);

/// Puts numbers in the place of the file's: the truth of states that were rounded to floats is what doubles give for the rounded ones.
void replaceTruth(TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers);

}  // namespace dyn::tool
