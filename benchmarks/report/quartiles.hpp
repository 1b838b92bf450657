// SPDX-License-Identifier: BSD-2-Clause
// Median and spread of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace dyn::benchmark {

struct Quartiles {
  double low = 0, median = 0, high = 0;
};

/// Number of calls of `ns` nanoseconds that make a sample of about 2 ms. An interrupt of some microseconds changes such a sample little.
inline int roundsInSample(double ns) { return std::clamp(static_cast<int>(2e6 / ns), 1, 1000); }

/// Quartiles of the samples; there must be at least one.
inline Quartiles quartiles(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  return {samples[n / 4], samples[n / 2], samples[3 * n / 4]};
}

}  // namespace dyn::benchmark
