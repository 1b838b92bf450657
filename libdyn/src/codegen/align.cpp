// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/align.hpp"

#include <algorithm>

namespace dyn {

std::vector<std::uint32_t> aligned(const std::vector<GraphNode>& nodes, const std::vector<std::uint32_t>& shorter,
                                   const std::vector<std::uint32_t>& longer) {
  constexpr std::size_t most_compared = std::size_t{1} << 22;
  const std::size_t rows = shorter.size(), columns = longer.size();
  std::vector<std::uint32_t> out(columns, no_node);
  if (rows == columns || rows * columns > most_compared) {
    std::copy(shorter.begin(), shorter.end(), out.begin());
    return out;
  }
  const auto gain = [&](std::size_t i, std::size_t j) {
    const std::uint32_t a = shorter[i], b = longer[j];
    if (a == no_node || b == no_node) return 1;
    return nodes[a].operation == nodes[b].operation ? 3 : 0;
  };
  // at(i, j): the largest gain if the first i entries of the shorter run have places among the first j of the longer one.
  std::vector<int> most((rows + 1) * (columns + 1), 0);
  const auto at = [&](std::size_t i, std::size_t j) -> int& { return most[i * (columns + 1) + j]; };
  for (std::size_t i = 1; i <= rows; ++i)
    for (std::size_t j = i; j <= columns - (rows - i); ++j) {
      const int beside = at(i - 1, j - 1) + gain(i - 1, j - 1);
      at(i, j) = j == i ? beside : std::max(beside, at(i, j - 1));
    }
  for (std::size_t i = rows, j = columns; i > 0; --j)
    if (j == i || at(i, j) != at(i, j - 1)) out[j - 1] = shorter[--i];
  return out;
}

}  // namespace dyn
