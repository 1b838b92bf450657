#include "peers/chart.hpp"

#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace dyn::benchmark::peers {

namespace {

constexpr const char* colours[] = {"#1b6ca8", "#d1495b", "#edae49", "#66a182", "#2e4057", "#8d6a9f", "#c97b4a", "#7a7a7a"};

void remember(std::vector<std::string>& names, const std::string& name) {
  if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' || c == '>' || c == '&' ? '_' : c;
  return out;
}

}  // namespace

void Chart::add(const std::string& robot, const std::string& library, double ns) {
  remember(robots_, robot);
  remember(libraries_, library);
  ns_[{robot, library}] = ns;
}

std::string Chart::write(const std::string& directory) const {
  constexpr double bar = 11, gap = 26, height = 320, left = 70, top = 50;
  double least = 1e300, most = 1;
  for (const auto& [key, ns] : ns_) {
    least = std::min(least, ns);
    most = std::max(most, ns);
  }
  const double low = std::floor(std::log10(std::min(least, most))), high = std::ceil(std::log10(most) + 1e-9);
  const auto y = [&](double ns) { return top + height * (high - std::log10(ns)) / (high - low); };
  const double group = bar * static_cast<double>(libraries_.size()) + gap;
  const double width = left + 20 + std::max(group * static_cast<double>(robots_.size()), 95 * static_cast<double>(libraries_.size()));
  std::ostringstream svg;
  svg << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" << width << "\" height=\"" << top + height + 70
      << "\" font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n";
  const auto text = [&](double x, double at, const std::string& what, const char* anchor) {
    svg << "<text x=\"" << x << "\" y=\"" << at << "\" text-anchor=\"" << anchor << "\">" << escaped(what) << "</text>\n";
  };
  text(left, 22, task_ + ": ns a call, logarithmic", "start");
  for (double decade = low; decade <= high; ++decade)
    for (int digit = 1; digit < (decade < high ? 10 : 2); ++digit) {
      const double ns = digit * std::pow(10, decade);
      svg << "<line x1=\"" << left << "\" x2=\"" << width - 20 << "\" y1=\"" << y(ns) << "\" y2=\"" << y(ns) << "\" stroke=\""
          << (digit == 1 ? "#999" : "#e6e6e6") << "\"/>\n";
      if (digit == 1) text(left - 8, y(ns) + 4, std::to_string(static_cast<long>(ns)), "end");
    }
  for (std::size_t r = 0; r < robots_.size(); ++r) {
    const double x0 = left + gap / 2 + group * static_cast<double>(r);
    for (std::size_t l = 0; l < libraries_.size(); ++l) {
      const auto found = ns_.find({robots_[r], libraries_[l]});
      if (found == ns_.end()) continue;
      svg << "<rect x=\"" << x0 + bar * static_cast<double>(l) << "\" y=\"" << y(found->second) << "\" width=\"" << bar - 1 << "\" height=\""
          << top + height - y(found->second) << "\" fill=\"" << colours[l % std::size(colours)] << "\"/>\n";
    }
    text(x0 + (group - gap) / 2, top + height + 18, robots_[r], "middle");
  }
  for (std::size_t l = 0; l < libraries_.size(); ++l) {
    const double x = left + 95 * static_cast<double>(l);
    svg << "<rect x=\"" << x << "\" y=\"" << top + height + 36 << "\" width=\"12\" height=\"12\" fill=\"" << colours[l % std::size(colours)]
        << "\"/>\n";
    text(x + 16, top + height + 46, libraries_[l], "start");
  }
  svg << "</svg>\n";
  std::string path = directory + "/" + task_ + ".svg";
  const std::string temporary = path + ".part";
  std::ofstream file(temporary);
  file << svg.str();
  file.close();
  if (!file || std::rename(temporary.c_str(), path.c_str()) != 0) throw Error(ErrorCode::file, "cannot be written", {path, 0, ""});
  return path;
}

}  // namespace dyn::benchmark::peers
