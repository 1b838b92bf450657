// Median and spread of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace dyn::benchmark {

struct Quartiles {
  double low = 0, median = 0, high = 0;
};

/// How many of what takes so long make a sample of about 2 ms, of which an interrupt of some microseconds is little.
inline int roundsInSample(double ns) { return std::clamp(static_cast<int>(2e6 / ns), 1, 1000); }

/// Of at least one sample.
inline Quartiles quartiles(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  return {samples[n / 4], samples[n / 2], samples[3 * n / 4]};
}

}  // namespace dyn::benchmark
