// SPDX-License-Identifier: BSD-2-Clause
#include "distribution.hpp"

#include <algorithm>

namespace dyn::tool::sweep {

namespace {

constexpr std::int64_t most_grid_points = std::int64_t{1} << 40;

std::vector<std::int64_t> countsOf(const json::Value& value, int size) {
  std::vector<std::int64_t> out;
  std::int64_t cells = 1;
  for (const double x : readNumbers(value, size)) {
    if (x < 1 || x > 1e9 || x != static_cast<double>(static_cast<std::int64_t>(x))) value.fail("a grid has a whole number of points, at least 1");
    out.push_back(static_cast<std::int64_t>(x));
    if (out.back() > most_grid_points / cells) value.fail("the grid has more than 2^40 points");
    cells *= out.back();
  }
  return out;
}

}  // namespace

std::int64_t Distribution::cells() const {
  if (kind == Kind::list) return static_cast<std::int64_t>(rows.size());
  std::int64_t product = 1;
  for (const std::int64_t count : counts) product *= count;
  return product;
}

void Distribution::draw(const RandomNumbers& random, std::uint32_t first, std::int64_t cell, double* out) const {
  for (int i = size - 1; i >= 0; --i) {
    const auto k = static_cast<std::size_t>(i);
    const std::uint32_t entry = first + static_cast<std::uint32_t>(i);
    switch (kind) {
      case Kind::fixed:
        out[i] = rows[0][k];
        break;
      case Kind::uniform:
        out[i] = rows[0][k] + (rows[1][k] - rows[0][k]) * random.uniform(entry);
        break;
      case Kind::normal:
        out[i] = rows[0][k] + rows[1][k] * random.normal(entry);
        break;
      case Kind::list:
        out[i] = rows[static_cast<std::size_t>(cell)][k];
        break;
      case Kind::grid: {
        const std::int64_t at = cell % counts[k];
        cell /= counts[k];
        const double part = counts[k] > 1 ? static_cast<double>(at) / static_cast<double>(counts[k] - 1) : 0;
        out[i] = (1 - part) * rows[0][k] + part * rows[1][k];
      }
    }
  }
}

std::vector<double> readNumbers(const json::Value& value, int size) {
  if (!value.json().is_array()) return std::vector<double>(static_cast<std::size_t>(size), finiteNumber(value));
  std::vector<double> out;
  value.each([&](const json::Value& entry) { out.push_back(finiteNumber(entry)); });
  if (out.size() != static_cast<std::size_t>(size))
    value.fail("must be one number or " + std::to_string(size) + " of them, not " + std::to_string(out.size()));
  return out;
}

Distribution readDistribution(const json::Value& value, int size, const std::function<std::vector<double>(const json::Value&)>& point) {
  const auto read = [&](const json::Value& x) { return point ? point(x) : readNumbers(x, size); };
  Distribution out;
  out.size = size;
  if (!value.json().is_object()) {
    out.rows = {read(value)};
    return out;
  }
  const std::vector<std::string> kinds{"uniform", "normal", "list", "grid"};
  if (value.json().size() != 1) value.fail("must have one member: uniform, normal, list or grid");
  const std::string kind = value.json().begin().key();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) unknownName(value, "distribution", kind, kinds);
  const json::Value given = value[kind.c_str()];
  std::vector<json::Value> entries;
  if (given.json().is_array()) given.each([&](const json::Value& entry) { entries.push_back(entry); });
  const auto need = [&](std::size_t count, const char* what) {
    if (entries.size() != count) given.fail(std::string("must be ") + what);
    out.rows = {readNumbers(entries[0], size), readNumbers(entries[1], size)};
  };
  if (kind == "uniform") {
    out.kind = Distribution::Kind::uniform;
    need(2, "[low, high]");
    for (std::size_t k = 0; k < out.rows[0].size(); ++k)
      if (out.rows[0][k] > out.rows[1][k]) given.fail("the lower bound is above the upper one");
  } else if (kind == "normal") {
    out.kind = Distribution::Kind::normal;
    need(2, "[mean, deviation]");
    for (const double deviation : out.rows[1])
      if (deviation < 0) given.fail("a deviation is not negative");
  } else if (kind == "list") {
    out.kind = Distribution::Kind::list;
    if (entries.empty()) given.fail("must be a list with at least one entry");
    for (const json::Value& entry : entries) out.rows.push_back(read(entry));
  } else {
    out.kind = Distribution::Kind::grid;
    need(3, "[first, last, count]");
    out.counts = countsOf(entries[2], size);
  }
  return out;
}

}  // namespace dyn::tool::sweep
