// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/near_names.hpp>

#include <algorithm>
#include <cctype>
#include <utility>

namespace dyn {

namespace {

/// Number of letters to insert, delete or replace (Levenshtein 1966). Upper and lower case count as equal.
std::size_t lettersBetween(const std::string& a, const std::string& b) {
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = diagonal + (lower(a[i - 1]) == lower(b[j - 1]) ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({replaced, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string nearNames(const std::string& name, const std::vector<std::string>& all) {
  constexpr std::size_t most_shown = 3, longest = 200;
  if (name.size() > longest) return "";
  std::vector<std::pair<std::size_t, std::string>> near;
  for (const std::string& other : all) {
    if (other.size() > longest) continue;
    const std::size_t letters = lettersBetween(name, other);
    const bool part = name.size() > 2 && (other.find(name) != std::string::npos || (other.size() > 2 && name.find(other) != std::string::npos));
    if (letters <= 1 + name.size() / 4 || part) near.emplace_back(letters, other);
  }
  std::sort(near.begin(), near.end());
  std::string out;
  for (std::size_t k = 0; k < std::min(near.size(), most_shown); ++k) out += (k == 0 ? "; did you mean '" : " or '") + near[k].second + "'";
  return out.empty() ? out : out + "?";
}

}  // namespace dyn
