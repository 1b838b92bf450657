// SPDX-License-Identifier: BSD-2-Clause
// A bar chart in groups, as SVG, such as the times of several methods for several tasks.
#pragma once

#include "report/quartiles.hpp"
#include "report/svg.hpp"

#include <map>
#include <string>
#include <vector>

namespace dyn::benchmark {

class BarChart {
 public:
  BarChart(std::string title, Scale scale) : title_(std::move(title)), scale_(scale) {}
  /// Adds a bar. Groups and series appear in the order of their first bars. Values that are not positive get no bar.
  void add(const std::string& group, const std::string& series, double value) { add(group, series, {value, value, value}); }
  /// Adds a bar for the median, with a line from the lower to the upper quartile.
  void add(const std::string& group, const std::string& series, const Quartiles& value);
  std::string svg() const;
  /// Writes a temporary file first, then renames it. Throws Error(file).
  void write(const std::string& path) const;

 private:
  Axis axis() const;

  std::string title_;
  Scale scale_;
  std::vector<std::string> groups_, series_;
  std::map<std::pair<std::string, std::string>, Quartiles> values_;
};

}  // namespace dyn::benchmark
