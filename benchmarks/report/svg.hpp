// What pictures of measurements share: axes with their marks, colours, and text that is safe within SVG.
#pragma once

#include <string>
#include <vector>

namespace dyn::benchmark {

enum class Scale { linear, logarithmic };

struct Mark {
  double value;
  bool named;
};

/// From low to high, of values or of their decimal logarithms.
struct Axis {
  double low = 0, high = 1;
  Scale scale = Scale::linear;
  std::vector<Mark> marks;

  /// Of the axis' length at which a value stands.
  double fraction(double value) const;
};

/// From zero to beyond the largest value, with marks at round numbers, or over whole decades.
Axis barAxis(double least, double most, Scale scale);
/// Around all values: marks at round numbers, or at decades, few enough to be read.
Axis lineAxis(double least, double most, Scale scale);

/// The k-th of eight, again from the first after the last.
const char* colour(std::size_t k);
std::string escaped(const std::string& text);
/// In as few digits as are needed: 0.001, 25, 1e-09.
std::string shortNumber(double value);

}  // namespace dyn::benchmark
