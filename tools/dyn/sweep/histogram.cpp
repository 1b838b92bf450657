// SPDX-License-Identifier: BSD-2-Clause
#include "histogram.hpp"

#include <algorithm>
#include <cmath>

namespace dyn::tool::sweep {

namespace {

constexpr double most_bins = 1 << 20;
constexpr std::size_t most_counts = std::size_t{1} << 24;

Histogram readHistogram(const json::Value& value, std::size_t index, const Field& field) {
  std::vector<double> x;
  value.each([&](const json::Value& entry) { x.push_back(finiteNumber(entry)); });
  if (x.size() != 3) value.fail("must be [lower, upper, bins]");
  const double lower = x[0], upper = x[1], bins = x[2], width = (upper - lower) / bins;
  if (!(bins >= 1 && bins <= most_bins && bins == std::floor(bins))) value.fail("has a whole number of bins, from 1 to 2^20");
  if (!(lower < upper) || !std::isfinite(width) || lower + width == lower)
    value.fail("the lower end must be below the upper one, and far enough for its bins");
  Histogram out;
  out.field = index;
  out.size = field.size();
  const auto count = static_cast<std::size_t>(bins);
  if (out.size > most_counts / (count + 3)) value.fail("has more than 2^24 bins for all numbers of the result together");
  for (std::size_t k = 0; k < count; ++k) out.edges.push_back(lower + static_cast<double>(k) * width);
  out.edges.push_back(upper);
  out.counts.resize(out.size * count);
  out.outside.resize(out.size * 3);
  return out;
}

}  // namespace

void Histogram::add(const double* numbers, std::size_t samples) {
  for (std::size_t k = 0; k < samples * size; ++k) {
    const double x = numbers[k];
    const std::size_t component = k % size;
    if (x >= edges.front() && x <= edges.back()) {
      const auto next = std::upper_bound(edges.begin(), edges.end() - 1, x) - edges.begin();
      counts[component * bins() + static_cast<std::size_t>(next) - 1] += 1;
    } else {
      outside[3 * component + (x < edges.front() ? 0 : x > edges.back() ? 1 : 2)] += 1;
    }
  }
}

std::vector<Histogram> readHistograms(const Study& study, const std::vector<Field>& fields) {
  std::vector<Histogram> out;
  if (!study.document.contains("histograms")) return out;
  const json::Value all = study.value()["histograms"];
  all.eachMember([&](const std::string& name, const json::Value& value) {
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const Field& f) { return f.name == name; });
    if (field == fields.end()) unknownName(all, "kept result", name, namesOf(fields));
    out.push_back(readHistogram(value, static_cast<std::size_t>(field - fields.begin()), *field));
  });
  return out;
}

}  // namespace dyn::tool::sweep
