// Curves over linear or logarithmic axes, as SVG that follows the reader's light or dark colours.
#pragma once

#include "report/svg.hpp"

#include <string>
#include <utility>
#include <vector>

namespace dyn::benchmark {

class LineChart {
 public:
  struct Label {
    std::string text;
    Scale scale = Scale::linear;
  };
  LineChart(std::string title, Label x, Label y) : title_(std::move(title)), x_(std::move(x)), y_(std::move(y)) {}

  /// A point of a curve, drawn in the order of adding. Points that an axis cannot show (not finite, or not positive where it is
  /// logarithmic) are left out, and counted in the legend.
  void add(const std::string& series, double x, double y, const std::string& label = "");
  /// A dashed line through a point with a slope in the axes' own measure, as y ~ x^slope where both are logarithmic.
  void guide(const std::string& name, double x, double y, double slope);
  /// Whether points are marked, as measurements are, or only joined.
  void markPoints(bool mark) { marks_ = mark; }
  /// Whether the points of a series are joined.
  void joinPoints(bool join) { joins_ = join; }

  std::string svg() const;
  /// Writes a temporary file first, then renames it. Throws Error(file).
  void write(const std::string& path) const;

 private:
  struct Point {
    double x, y;
    std::string label;
  };
  struct Series {
    std::string name;
    std::vector<Point> points;
    int left_out = 0;
  };
  struct Guide {
    std::string name;
    double x, y, slope;
  };

  std::string title_;
  Label x_, y_;
  std::vector<Series> series_;
  std::vector<Guide> guides_;
  bool marks_ = true, joins_ = true;
};

}  // namespace dyn::benchmark
