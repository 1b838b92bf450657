// Curves over linear or logarithmic axes, as SVG that follows the reader's light or dark colours.
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

  /// A point of a curve, drawn in the order of adding. Points that an axis cannot show (not finite, or not positive where it is
  /// logarithmic) are left out, and counted in the legend. A label that finds no free place is left out; the point's tooltip has it.
  void add(const std::string& series, double x, double y, const std::string& label = "");
  /// A dashed line through a point with a slope in the axes' own measure, as y ~ x^slope where both are logarithmic.
  void guide(const std::string& name, double x, double y, double slope);
  /// Words below the title.
  void note(std::string text) { note_ = std::move(text); }
  /// Whether points are marked, as measurements are, or only joined.
  void markPoints(bool mark) { marks_ = mark; }
  /// Whether the points of a series are joined.
  void joinPoints(bool join) { joins_ = join; }
  /// Whether names stand at the ends of curves, and not in a legend: for a few curves that end side by side.
  void nameAtEnds(bool name) { names_at_ends_ = name; }
  /// Sets the height of the part within the axes. The whole picture is 640 wide.
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

  /// Right of the axes: names at the ends of curves.
  double roomForNames() const;
  /// Writes the content of svg(), with so much room for names; returns its height.
  double draw(std::ostringstream& svg, double room) const;

  std::string title_, note_;
  Label x_, y_;
  std::vector<Series> series_;
  std::vector<Guide> guides_;
  double height_ = 320;
  bool marks_ = true, joins_ = true, names_at_ends_ = false;
};

/// One picture of several, one below the other.
std::string stacked(const std::vector<LineChart>& charts);

}  // namespace dyn::benchmark
