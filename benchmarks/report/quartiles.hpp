// Median and spread of repeated measurements.
#pragma once

#include <algorithm>
#include <vector>

namespace dyn::benchmark {

struct Quartiles {
  double low = 0, median = 0, high = 0;
};

/// Of at least one sample.
inline Quartiles quartiles(std::vector<double> samples) {
  std::sort(samples.begin(), samples.end());
  const std::size_t n = samples.size();
  return {samples[n / 4], samples[n / 2], samples[3 * n / 4]};
}

}  // namespace dyn::benchmark
