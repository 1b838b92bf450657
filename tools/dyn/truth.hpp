// References of more digits than a double has, and how far results are from them.
#pragma once

#include "states.hpp"

#include <map>

namespace dyn::tool {

struct TruthSample {
  State state;
  std::map<std::string, std::vector<long double>> truth;
};

/// Reads {"samples":[{"q":[],"v":[],"a":[],"tau":[],"truth":{"rnea":[],"rnea_scale":[],"nle":[],"gravity":[],"aba":[],"aba_scale":[],
/// "M":[]}}]}: truths are numbers or strings of digits, keys may be missing. Throws Error(file | syntax | size) naming the file.
std::vector<TruthSample> readTruth(const std::string& path, const CompactModel& model);

/// How far the numbers that `algorithm` (by its name in dyn bench) gave are from the truth, in units of u: by the scales that the
/// file gives for rnea, nle, gravity and aba, by the largest entry for crba. NaN where the file has no such truth, infinite for numbers that
/// are not finite.
double truthError(const TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers, double u);

/// Puts numbers in the place of the file's: the truth of states that were rounded to floats is what doubles give for the rounded ones.
void replaceTruth(TruthSample& sample, const std::string& algorithm, const Eigen::VectorXd& numbers);

}  // namespace dyn::tool
