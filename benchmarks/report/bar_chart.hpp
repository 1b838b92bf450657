// Bars in groups, as SVG: times of several ways to do several things.
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
  /// Groups and series stand in the order of their first bars. Only positive values have a bar.
  void add(const std::string& group, const std::string& series, double value) { add(group, series, {value, value, value}); }
  /// The same, of the median, with a line from quartile to quartile.
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
