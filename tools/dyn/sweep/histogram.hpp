// SPDX-License-Identifier: BSD-2-Clause
// Counts of a result over all samples.
#pragma once

#include "task.hpp"

namespace dyn::tool::sweep {

/// Each number of a result has bins of its own: bin k has x with edges[k] <= x < edges[k + 1], and the last one its upper edge as well.
struct Histogram {
  std::size_t field = 0;        ///< index of the result among the fields
  std::size_t size = 1;         ///< numbers of that result in one sample
  std::vector<double> edges;    ///< one more than bins
  std::vector<double> counts;   ///< bins of the first number, then those of the next
  std::vector<double> outside;  ///< for each number: below, above, and not a number

  std::size_t bins() const { return edges.size() - 1; }
  /// Counts the numbers of some samples, one sample after another.
  void add(const double* numbers, std::size_t samples);
};

/// Reads the member "histograms" of a study. Throws Error(syntax) for a result that is not kept.
std::vector<Histogram> readHistograms(const Study& study, const std::vector<Field>& fields);

}  // namespace dyn::tool::sweep
