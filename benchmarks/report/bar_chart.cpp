#include "report/bar_chart.hpp"

#include <dyn/file.hpp>

#include <algorithm>
#include <sstream>

namespace dyn::benchmark {

namespace {

constexpr double bar = 14, gap = 28, height = 320, left = 70, top = 50, legend = 130;

void remember(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

}  // namespace

Axis BarChart::axis() const {
  double least = 1e300, most = 0;
  for (const auto& [key, value] : values_) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  if (most == 0) least = most = 1;
  return barAxis(least, most, scale_);
}

void BarChart::add(const std::string& group, const std::string& series, double value) {
  remember(groups_, group);
  remember(series_, series);
  if (value > 0) values_[{group, series}] = value;
}

std::string BarChart::svg() const {
  const Axis axis = this->axis();
  const auto groups = static_cast<double>(groups_.size()), series = static_cast<double>(series_.size());
  const double group = bar * series + gap, width = left + 20 + std::max(group * groups, legend * series);
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << top + height + 70
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
    const double x = left + gap / 2 + group * static_cast<double>(g);
    for (std::size_t s = 0; s < series_.size(); ++s) {
      const auto found = values_.find({groups_[g], series_[s]});
      if (found == values_.end()) continue;
      const double y = heightOf(found->second);
      box(x + bar * static_cast<double>(s), y, bar - 2, top + height - y, s);
    }
    text(x + (group - gap) / 2, top + height + 18, groups_[g], "middle");
  }
  for (std::size_t s = 0; s < series_.size(); ++s) {
    const double x = left + legend * static_cast<double>(s);
    box(x, top + height + 36, 12, 12, s);
    text(x + 16, top + height + 46, series_[s], "start");
  }
  svg << "</svg>\n";
  return svg.str();
}

void BarChart::write(const std::string& path) const { replaceFile(path, svg()); }

}  // namespace dyn::benchmark
