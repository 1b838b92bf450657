// SPDX-License-Identifier: BSD-2-Clause
#include "report/svg.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

namespace dyn::benchmark {

double Axis::fraction(double value) const {
  const double at = scale == Scale::logarithmic ? std::log10(value) : value;
  return (at - low) / (high - low);
}

Axis barAxis(double least, double most, Scale scale) {
  if (scale == Scale::linear) return lineAxis(0, most, scale);
  Axis axis{0, most, scale, {}};
  axis.low = std::floor(std::log10(least));
  axis.high = std::max(std::ceil(std::log10(most)), axis.low + 1);
  for (double decade = axis.low; decade <= axis.high; ++decade)
    for (int digit = 1; digit < (decade < axis.high ? 10 : 2); ++digit) axis.marks.push_back({digit * std::pow(10, decade), digit == 1});
  return axis;
}

Axis lineAxis(double least, double most, Scale scale) {
  Axis axis{0, 1, scale, {}};
  if (scale == Scale::logarithmic) {
    axis.low = std::floor(std::log10(least));
    axis.high = std::max(std::ceil(std::log10(most)), axis.low + 1);
    const double every = std::ceil((axis.high - axis.low) / 8);
    for (double decade = axis.low; decade <= axis.high; ++decade)
      axis.marks.push_back({std::pow(10, decade), std::fmod(decade - axis.low, every) == 0});
    return axis;
  }
  const double span = most > least ? most - least : std::max(std::abs(most), 1.0);
  // The step is 1, 2 or 5 times a power of ten, such that about five steps cover the span.
  const double rough = span / 5, power = std::pow(10, std::floor(std::log10(rough))), digit = rough / power;
  const double step = power * (digit < 1.5 ? 1 : digit < 3.5 ? 2 : digit < 7.5 ? 5 : 10);
  axis.low = std::floor(least / step) * step;
  axis.high = std::max(std::ceil(most / step) * step, axis.low + step);
  for (int k = 0; axis.low + k * step <= axis.high + 0.5 * step; ++k) axis.marks.push_back({axis.low + k * step, true});
  return axis;
}

const char* colour(std::size_t k) {
  static constexpr const char* colours[] = {"#1b6ca8", "#d1495b", "#edae49", "#66a182", "#2aa1a1", "#8d6a9f", "#c97b4a", "#7a7a7a"};
  return colours[k % std::size(colours)];
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : c == '"' ? "&quot;" : std::string(1, c);
  return out;
}

std::string shortNumber(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", std::abs(value) < 1e-300 ? 0.0 : value);
  return text;
}

}  // namespace dyn::benchmark
