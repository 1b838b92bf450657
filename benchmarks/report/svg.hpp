// SPDX-License-Identifier: BSD-2-Clause
// Shared by all charts: axes with their marks, colours, and text that is safe within SVG.
#pragma once

#include <string>
#include <vector>

namespace dyn::benchmark {

enum class Scale { linear, logarithmic };

struct Mark {
  double value;
  bool named;
};

/// An axis from `low` to `high`. Both are decimal logarithms of values if the scale is logarithmic.
struct Axis {
  double low = 0, high = 1;
  Scale scale = Scale::linear;
  std::vector<Mark> marks;

  /// Position of a value on the axis, as a fraction of the axis' length.
  double fraction(double value) const;
};

/// Axis for bars: from zero to beyond the largest value with marks at round numbers, or, if logarithmic, over whole decades.
Axis barAxis(double least, double most, Scale scale);
/// Axis for curves: covers all values, with readably few marks at round numbers or at decades.
Axis lineAxis(double least, double most, Scale scale);

/// The colour of index k. There are eight colours; they repeat.
const char* colour(std::size_t k);
std::string escaped(const std::string& text);
/// Formats a value with up to four significant digits and no trailing zeros: 0.001, 25, 1e-09.
std::string shortNumber(double value);

}  // namespace dyn::benchmark
