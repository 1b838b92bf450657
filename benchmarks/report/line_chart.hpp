// SPDX-License-Identifier: BSD-2-Clause
// A chart of curves over linear or logarithmic axes, as SVG that follows the reader's light or dark colour scheme.
#pragma once

#include "report/svg.hpp"

#include <sstream>
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

  /// Adds a point to a curve; points are joined in the order of adding. A point that an axis cannot show (not finite, or not positive on a
  /// logarithmic axis) is left out and counted in the legend. A label without a free place is left out, but the point's tooltip shows it.
  void add(const std::string& series, double x, double y, const std::string& label = "");
  /// Draws a dashed line through (x, y) with a slope in coordinates of the axes: y ~ x^slope if both axes are logarithmic.
  void guide(const std::string& name, double x, double y, double slope);
  /// Sets the text below the title.
  void note(std::string text) { note_ = std::move(text); }
  /// Sets whether each point gets a dot, as measurements do.
  void markPoints(bool mark) { marks_ = mark; }
  /// Sets whether the points of a series are joined.
  void joinPoints(bool join) { joins_ = join; }
  /// Sets whether names stand at the ends of the curves instead of in a legend. This suits a few curves that end side by side.
  void nameAtEnds(bool name) { names_at_ends_ = name; }
  /// Sets the height of the area within the axes. The whole picture is 640 wide.
  void setHeight(double height) { height_ = height; }

  std::string svg() const;
  /// Writes a temporary file first, then renames it. Throws Error(file).
  void write(const std::string& path) const;

 private:
  friend std::string stacked(const std::vector<LineChart>& charts);
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
  class Drawing;
  static std::string nameOf(const Series& s);

  /// Width that the names at the ends of the curves need right of the axes.
  double roomForNames() const;
  /// Writes the content of svg() with `room` for names right of the axes. Returns its height.
  double draw(std::ostringstream& svg, double room) const;

  std::string title_, note_;
  Label x_, y_;
  std::vector<Series> series_;
  std::vector<Guide> guides_;
  double height_ = 320;
  bool marks_ = true, joins_ = true, names_at_ends_ = false;
};

/// Returns one picture of several charts, one below the other.
std::string stacked(const std::vector<LineChart>& charts);

}  // namespace dyn::benchmark
