#include "report/line_chart.hpp"

#include <dyn/file.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace dyn::benchmark {

namespace {

constexpr double width = 640, left = 72, right = 16, top = 40, height = 320, legend_line = 20, legend_columns = 3;

bool shows(Scale scale, double value) { return std::isfinite(value) && (scale == Scale::linear || value > 0); }

/// Of a value in the axis' own measure.
double measure(Scale scale, double value) { return scale == Scale::logarithmic ? std::log10(value) : value; }

}  // namespace

void LineChart::add(const std::string& series, double x, double y, const std::string& label) {
  auto found = std::find_if(series_.begin(), series_.end(), [&](const Series& s) { return s.name == series; });
  if (found == series_.end()) found = series_.insert(series_.end(), {series, {}, 0});
  if (shows(x_.scale, x) && shows(y_.scale, y)) {
    found->points.push_back({x, y, label});
  } else {
    ++found->left_out;
  }
}

void LineChart::guide(const std::string& name, double x, double y, double slope) {
  if (shows(x_.scale, x) && shows(y_.scale, y)) guides_.push_back({name, x, y, slope});
}

std::string LineChart::svg() const {
  double least_x = HUGE_VAL, most_x = -HUGE_VAL, least_y = HUGE_VAL, most_y = -HUGE_VAL;
  for (const Series& s : series_)
    for (const auto& [x, y, label] : s.points) {
      least_x = std::min(least_x, x);
      most_x = std::max(most_x, x);
      least_y = std::min(least_y, y);
      most_y = std::max(most_y, y);
    }
  if (least_x > most_x) least_x = most_x = least_y = most_y = 1;
  const Axis horizontal = lineAxis(least_x, most_x, x_.scale), vertical = lineAxis(least_y, most_y, y_.scale);
  const auto across = [&](double x) { return left + (width - left - right) * horizontal.fraction(x); };
  const auto down = [&](double y) { return top + height * (1 - vertical.fraction(y)); };
  const double rows = std::ceil(static_cast<double>(series_.size()) / legend_columns), whole = top + height + 56 + legend_line * rows;

  std::ostringstream svg;
  svg << std::setprecision(6);
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << whole
      << "\" font-family=\"sans-serif\" font-size=\"13\" role=\"img\" aria-label=\"" << escaped(title_) << "\">\n"
      << "<style>.paper{fill:#fff}.ink{fill:#222}.grid{stroke:#ddd}.guide{stroke:#888;stroke-dasharray:5 4}"
         "@media (prefers-color-scheme:dark){.paper{fill:#16191d}.ink{fill:#ddd}.grid{stroke:#3a4048}}</style>\n"
      << "<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n";
  const auto text = [&](double x, double y, const std::string& what, const char* anchor, const char* more = "") {
    svg << "<text class=\"ink\" x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\"" << more << ">" << escaped(what) << "</text>\n";
  };
  const auto line = [&](const char* kind, double x1, double y1, double x2, double y2) {
    svg << "<line class=\"" << kind << "\" x1=\"" << x1 << "\" y1=\"" << y1 << "\" x2=\"" << x2 << "\" y2=\"" << y2 << "\"/>\n";
  };
  text(left, 22, title_, "start", " font-weight=\"bold\"");
  for (const Mark& mark : horizontal.marks) {
    line("grid", across(mark.value), top, across(mark.value), top + height);
    // The last number stays within the picture.
    if (mark.named) text(across(mark.value), top + height + 18, shortNumber(mark.value), horizontal.fraction(mark.value) > 0.98 ? "end" : "middle");
  }
  for (const Mark& mark : vertical.marks) {
    line("grid", left, down(mark.value), width - right, down(mark.value));
    if (mark.named) text(left - 6, down(mark.value) + 4, shortNumber(mark.value), "end");
  }
  text(0.5 * (left + width - right), top + height + 38, x_.text, "middle");
  text(0, 0, y_.text, "middle", (" transform=\"translate(14 " + std::to_string(top + height / 2) + ") rotate(-90)\"").c_str());

  for (const Guide& g : guides_) {
    // Where the line enters and leaves the frame, in the axes' measure.
    const double x0 = measure(x_.scale, g.x), y0 = measure(y_.scale, g.y);
    double from = horizontal.low, to = horizontal.high;
    if (g.slope != 0) {
      const double a = x0 + (vertical.low - y0) / g.slope, b = x0 + (vertical.high - y0) / g.slope;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    if (!(from < to)) continue;
    const auto px = [&](double x) { return left + (width - left - right) * (x - horizontal.low) / (horizontal.high - horizontal.low); };
    const auto py = [&](double x) { return top + height * (1 - (y0 + g.slope * (x - x0) - vertical.low) / (vertical.high - vertical.low)); };
    line("guide", px(from), py(from), px(to), py(to));
    text(px(to) - 4, py(to) + (g.slope < 0 ? -4 : 14), g.name, "end", " font-size=\"11\"");
  }
  for (std::size_t k = 0; k < series_.size(); ++k) {
    const Series& s = series_[k];
    // The second eight curves are dashed.
    const char* dashes = (k / 8) % 2 ? " stroke-dasharray=\"6 3\"" : "";
    if (joins_) {
      svg << "<polyline fill=\"none\" stroke-width=\"1.8\" stroke=\"" << colour(k) << "\"" << dashes << " points=\"";
      for (const Point& point : s.points) svg << across(point.x) << ',' << down(point.y) << ' ';
      svg << "\"/>\n";
    }
    for (const Point& point : s.points) {
      if (marks_)
        svg << "<circle r=\"3.5\" fill=\"" << colour(k) << "\" cx=\"" << across(point.x) << "\" cy=\"" << down(point.y) << "\"><title>"
            << escaped(s.name + " " + point.label + ": " + shortNumber(point.x) + ", " + shortNumber(point.y)) << "</title></circle>\n";
      if (!point.label.empty()) text(across(point.x) + 5, down(point.y) - 4, point.label, "start", " font-size=\"9\"");
    }
    const auto column = static_cast<double>(k % static_cast<std::size_t>(legend_columns)), row = std::floor(static_cast<double>(k) / legend_columns);
    const double x = left + (width - left - right) / legend_columns * column, y = top + height + 58 + legend_line * row;
    svg << "<line x1=\"" << x << "\" x2=\"" << x + 22 << "\" y1=\"" << y << "\" y2=\"" << y << "\" stroke-width=\"3\" stroke=\"" << colour(k) << "\""
        << dashes << "/>\n";
    text(x + 28, y + 4, s.left_out ? s.name + " (" + std::to_string(s.left_out) + " off)" : s.name, "start");
  }
  svg << "</svg>\n";
  return svg.str();
}

void LineChart::write(const std::string& path) const { replaceFile(path, svg()); }

}  // namespace dyn::benchmark
