// SPDX-License-Identifier: BSD-2-Clause
#include "report/line_chart.hpp"

#include "report/labels.hpp"

#include <dyn/file.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <optional>

namespace dyn::benchmark {

namespace {

constexpr double width = 640, left = 72, letter = 13, line_height = 18, most_names = 190;

bool shows(Scale scale, double value) { return std::isfinite(value) && (scale == Scale::linear || value > 0); }

/// The coordinate of a value on an axis: the value itself, or its decimal logarithm.
double measure(Scale scale, double value) { return scale == Scale::logarithmic ? std::log10(value) : value; }

std::string whole(double height, const std::string& about, const std::string& content) {
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << height
      << "\" font-family=\"sans-serif\" font-size=\"13\" role=\"img\" aria-label=\"" << escaped(about) << "\">\n"
      << "<style>.paper{fill:#fff}.ink{fill:#222}.grid{stroke:#ddd}.guide{stroke:#888;stroke-dasharray:5 4}"
         "@media (prefers-color-scheme:dark){.paper{fill:#16191d}.ink{fill:#ddd}.grid{stroke:#3a4048}}</style>\n"
      << "<rect class=\"paper\" width=\"100%\" height=\"100%\"/>\n"
      << content << "</svg>\n";
  return svg.str();
}

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

std::string LineChart::nameOf(const Series& s) { return s.left_out ? s.name + " (" + std::to_string(s.left_out) + " off)" : s.name; }

/// One chart, from its title down to its legend.
class LineChart::Drawing {
 public:
  Drawing(const LineChart& chart, std::ostringstream& svg, double room) : c_(chart), svg_(svg), right_(room) {
    double least_x = HUGE_VAL, most_x = -HUGE_VAL, least_y = HUGE_VAL, most_y = -HUGE_VAL;
    for (const Series& s : c_.series_) {
      for (const auto& [x, y, label] : s.points) {
        least_x = std::min(least_x, x);
        most_x = std::max(most_x, x);
        least_y = std::min(least_y, y);
        most_y = std::max(most_y, y);
      }
    }
    if (least_x > most_x) least_x = most_x = least_y = most_y = 1;
    horizontal_ = lineAxis(least_x, most_x, c_.x_.scale);
    vertical_ = lineAxis(least_y, most_y, c_.y_.scale);
  }

  double all() {
    heading();
    axes();
    for (const Guide& g : c_.guides_) guide(g);
    for (std::size_t k = 0; k < c_.series_.size(); ++k) curve(c_.series_[k], k);
    const double below = top_ + c_.height_ + 56;
    if (!c_.names_at_ends_) return below + legend(below);
    names();
    return below;
  }

 private:
  double inner() const { return width - left - right_; }
  double across(double x) const { return left + inner() * horizontal_.fraction(x); }
  double down(double y) const { return top_ + c_.height_ * (1 - vertical_.fraction(y)); }
  /// The second eight curves are dashed.
  static const char* dashesOf(std::size_t k) { return (k / 8) % 2 ? " stroke-dasharray=\"6 3\"" : ""; }

  void text(double x, double y, const std::string& what, const char* anchor, const std::string& more = "") {
    svg_ << "<text class=\"ink\" x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\"" << more << ">" << escaped(what) << "</text>\n";
  }
  void line(const char* kind, double x1, double y1, double x2, double y2) {
    svg_ << "<line class=\"" << kind << "\" x1=\"" << x1 << "\" y1=\"" << y1 << "\" x2=\"" << x2 << "\" y2=\"" << y2 << "\"/>\n";
  }

  void heading() {
    top_ = 22;
    const auto lines = [&](const std::string& words, double size, const std::string& style) {
      for (const std::string& l : wrapped(words, size, width - left - 16)) {
        text(left, top_, l, "start", style);
        top_ += line_height;
      }
    };
    lines(c_.title_, 1.07 * letter, " font-weight=\"bold\"");
    lines(c_.note_, 11, " font-size=\"11\"");
  }

  void axes() {
    const double bottom = top_ + c_.height_;
    for (const Mark& mark : horizontal_.marks) {
      line("grid", across(mark.value), top_, across(mark.value), bottom);
      // The last number stays within the picture.
      const char* anchor = horizontal_.fraction(mark.value) > 0.98 ? "end" : "middle";
      if (mark.named) text(across(mark.value), bottom + 18, shortNumber(mark.value), anchor);
    }
    for (const Mark& mark : vertical_.marks) {
      line("grid", left, down(mark.value), left + inner(), down(mark.value));
      if (mark.named) text(left - 6, down(mark.value) + 4, shortNumber(mark.value), "end");
    }
    text(left + 0.5 * inner(), bottom + 38, c_.x_.text, "middle");
    text(0, 0, c_.y_.text, "middle", " transform=\"translate(14 " + std::to_string(top_ + c_.height_ / 2) + ") rotate(-90)\"");
  }

  void guide(const Guide& g) {
    // x0, y0, from and to are coordinates on the axes. The line enters the frame at `from` and leaves it at `to`.
    const double x0 = measure(c_.x_.scale, g.x), y0 = measure(c_.y_.scale, g.y);
    double from = horizontal_.low, to = horizontal_.high;
    if (g.slope != 0) {
      const double a = x0 + (vertical_.low - y0) / g.slope, b = x0 + (vertical_.high - y0) / g.slope;
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    if (!(from < to)) return;
    const auto px = [&](double x) { return left + inner() * (x - horizontal_.low) / (horizontal_.high - horizontal_.low); };
    const auto py = [&](double x) { return top_ + c_.height_ * (1 - (y0 + g.slope * (x - x0) - vertical_.low) / (vertical_.high - vertical_.low)); };
    line("guide", px(from), py(from), px(to), py(to));
    label(g.name, px(to), py(to), 11);
  }

  /// Writes `what` beside a point, in the first of four corners that is free.
  void label(const std::string& what, double x, double y, double size) {
    const double w = textWidth(what, size), h = size + 1;
    const double lefts[] = {x + 5, x + 5, x - 5 - w, x - 5 - w}, baselines[] = {y - 4, y + h + 1, y - 4, y + h + 1};
    std::vector<Box> places;
    for (int k = 0; k < 4; ++k) places.push_back({lefts[k], baselines[k] - size, w, h});
    if (!space_) space_.emplace(Box{left, top_, inner() + right_ - 2, c_.height_});
    const int k = space_->takeFirst(places);
    if (k >= 0) text(lefts[k], baselines[k], what, "start", " font-size=\"" + std::to_string(static_cast<int>(size)) + "\"");
  }

  void curve(const Series& s, std::size_t k) {
    if (c_.joins_) {
      svg_ << "<polyline fill=\"none\" stroke-width=\"1.8\" stroke=\"" << colour(k) << "\"" << dashesOf(k) << " points=\"";
      for (const Point& point : s.points) svg_ << across(point.x) << ',' << down(point.y) << ' ';
      svg_ << "\"/>\n";
    }
    for (const Point& point : s.points) {
      if (c_.marks_)
        svg_ << "<circle r=\"3.5\" fill=\"" << colour(k) << "\" cx=\"" << across(point.x) << "\" cy=\"" << down(point.y) << "\"><title>"
             << escaped(s.name + " " + point.label + ": " + shortNumber(point.x) + ", " + shortNumber(point.y)) << "</title></circle>\n";
      if (!point.label.empty()) label(point.label, across(point.x), down(point.y), 9);
    }
  }

  /// Draws the legend in as many columns as the longest name allows. Returns its height.
  double legend(double y0) {
    double entry = 0;
    for (const Series& s : c_.series_) entry = std::max(entry, 28 + textWidth(nameOf(s), letter) + 14);
    const std::size_t columns = std::max<std::size_t>(1, static_cast<std::size_t>((width - left) / std::max(entry, 1.0)));
    for (std::size_t k = 0; k < c_.series_.size(); ++k) {
      const auto row = k / columns;
      const double x = left + entry * static_cast<double>(k % columns), y = y0 + 2 + 20 * static_cast<double>(row);
      svg_ << "<line x1=\"" << x << "\" x2=\"" << x + 22 << "\" y1=\"" << y << "\" y2=\"" << y << "\" stroke-width=\"3\" stroke=\"" << colour(k)
           << "\"" << dashesOf(k) << "/>\n";
      text(x + 28, y + 4, nameOf(c_.series_[k]), "start");
    }
    return 20 * std::ceil(static_cast<double>(c_.series_.size()) / static_cast<double>(columns));
  }

  void names() {
    std::vector<double> wanted;
    for (const Series& s : c_.series_) wanted.push_back(s.points.empty() ? top_ : down(s.points.back().y));
    const std::vector<double> places = spread(wanted, 14, top_ + 4, top_ + c_.height_);
    for (std::size_t k = 0; k < c_.series_.size(); ++k) {
      const double x = left + inner();
      svg_ << "<line x1=\"" << x + 1 << "\" x2=\"" << x + 8 << "\" y1=\"" << wanted[k] << "\" y2=\"" << places[k] << "\" stroke=\"" << colour(k)
           << "\"/>\n<text x=\"" << x + 11 << "\" y=\"" << places[k] + 4 << "\" fill=\"" << colour(k) << "\"";
      const std::string name = nameOf(c_.series_[k]);
      if (textWidth(name, letter) + 14 > right_) svg_ << " textLength=\"" << right_ - 14 << "\" lengthAdjust=\"spacingAndGlyphs\"";
      svg_ << ">" << escaped(name) << "</text>\n";
    }
  }

  const LineChart& c_;
  std::ostringstream& svg_;
  Axis horizontal_, vertical_;
  double right_, top_ = 40;
  std::optional<FreeSpace> space_;
};

double LineChart::roomForNames() const {
  double room = 16;
  for (const Series& s : series_)
    if (names_at_ends_) room = std::max(room, std::min(textWidth(nameOf(s), letter) + 14, most_names));
  return room;
}

double LineChart::draw(std::ostringstream& svg, double room) const {
  svg << std::setprecision(6);
  return Drawing(*this, svg, room).all();
}

std::string LineChart::svg() const {
  std::ostringstream content;
  const double height = draw(content, roomForNames());
  return whole(height, title_, content.str());
}

void LineChart::write(const std::string& path) const { replaceFile(path, svg()); }

std::string stacked(const std::vector<LineChart>& charts) {
  double height = 0, room = 0;
  for (const LineChart& chart : charts) room = std::max(room, chart.roomForNames());
  std::ostringstream all;
  for (const LineChart& chart : charts) {
    std::ostringstream content;
    const double own = chart.draw(content, room);
    all << "<g transform=\"translate(0 " << height << ")\">\n" << content.str() << "</g>\n";
    height += own;
  }
  return whole(std::max(height, 1.0), charts.empty() ? "" : charts.front().title_, all.str());
}

}  // namespace dyn::benchmark
