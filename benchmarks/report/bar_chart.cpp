// SPDX-License-Identifier: BSD-2-Clause
#include "report/bar_chart.hpp"

#include "report/labels.hpp"

#include <dyn/file.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace dyn::benchmark {

namespace {

constexpr double bar = 14, gap = 28, height = 320, left = 70, top = 50, letter = 12;

void remember(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

Axis BarChart::axis() const {
  double least = 1e300, most = 0;
  for (const auto& [key, value] : values_) {
    least = std::min(least, value.low);
    most = std::max(most, value.high);
  }
  if (most == 0) least = most = 1;
  return barAxis(least, most, scale_);
}

void BarChart::add(const std::string& group, const std::string& series, const Quartiles& value) {
  remember(groups_, group);
  remember(series_, series);
  if (value.low > 0) values_[{group, series}] = value;
}

std::string BarChart::svg() const {
  const Axis axis = this->axis();
  const auto groups = static_cast<double>(groups_.size()), series = static_cast<double>(series_.size());
  double group = bar * series + gap, entry = 0;
  for (const std::string& name : groups_) group = std::max(group, textWidth(name, letter) + 10);
  for (const std::string& name : series_) entry = std::max(entry, 16 + textWidth(name, letter) + 16);
  const double width = left + 20 + std::max({group * groups, entry * std::min(series, 4.0), textWidth(title_, letter)});
  if (groups > 0) group = std::max(group, (width - left - 20) / groups);
  const std::size_t columns = std::max<std::size_t>(1, static_cast<std::size_t>((width - left) / entry));
  const double rows = std::ceil(series / static_cast<double>(columns));
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " << width << ' ' << top + height + 46 + 20 * rows << "\" width=\"" << width
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  const auto heightOf = [&](double value) { return top + height * (1 - axis.fraction(value)); };
  const auto text = [&](double x, double y, const std::string& what, const char* anchor) {
    svg << "<text x=\"" << x << "\" y=\"" << y << "\" text-anchor=\"" << anchor << "\">" << escaped(what) << "</text>\n";
  };
  const auto box = [&](double x, double y, double w, double h, std::size_t k) {
    svg << "<rect x=\"" << x << "\" y=\"" << y << "\" width=\"" << w << "\" height=\"" << h << "\" fill=\"" << colour(k) << "\"/>\n";
  };
  text(left, 22, title_, "start");
  for (const Mark& mark : axis.marks) {
    const double y = heightOf(mark.value);
    svg << "<line x1=\"" << left << "\" x2=\"" << width - 20 << "\" y1=\"" << y << "\" y2=\"" << y << "\" stroke=\""
        << (mark.named ? "#999" : "#e6e6e6") << "\"/>\n";
    if (!mark.named) continue;
    text(left - 8, y + 4, shortNumber(mark.value), "end");
  }
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    const double x = left + (group - bar * series) / 2 + group * static_cast<double>(g);
    for (std::size_t s = 0; s < series_.size(); ++s) {
      const auto found = values_.find({groups_[g], series_[s]});
      if (found == values_.end()) continue;
      const Quartiles& value = found->second;
      const double y = heightOf(value.median), at = x + bar * static_cast<double>(s);
      box(at, y, bar - 2, top + height - y, s);
      if (value.low == value.high) continue;
      const double middle = at + bar / 2 - 1;
      svg << "<path stroke=\"#222\" d=\"M" << middle << ' ' << heightOf(value.low) << 'V' << heightOf(value.high) << "m-3 0h6\"/>\n";
    }
    text(x + bar * series / 2, top + height + 18, groups_[g], "middle");
  }
  for (std::size_t s = 0; s < series_.size(); ++s) {
    const auto row = s / columns;
    const double x = left + entry * static_cast<double>(s % columns), y = top + height + 36 + 20 * static_cast<double>(row);
    box(x, y, 12, 12, s);
    text(x + 16, y + 10, series_[s], "start");
  }
  svg << "</svg>\n";
  return svg.str();
}

void BarChart::write(const std::string& path) const { replaceFile(path, svg()); }

}  // namespace dyn::benchmark
