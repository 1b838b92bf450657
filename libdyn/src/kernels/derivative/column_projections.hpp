// SPDX-License-Identifier: BSD-2-Clause
// The right-hand sides of products with M^-1 for many states at once, where a number is a pack of states.
#pragma once

#include "kernels/derivative/tile.hpp"
#include "kernels/derivative/tree_factors.hpp"

#include <cstddef>

namespace dyn::kernels {

/// Columns that are written together. Their sums, of four rows each, fit into registers together with a number of U and the columns' projections.
template <class S>
constexpr int columns_together = sizeof(S) == 64 ? 6 : 3;

/// Calls use(columns, j) for each set of a chain's columns that are written together: `columns` of them, a constant, from j on.
template <class S, class Use>
void inColumns(const DofChain& chain, Use&& use) {
  inBlocks<columns_together<S>>(chain.begin, chain.end, use);
}

/// The projections right(k, j) / D(k) of two products M^-1 x, where k are the degrees of freedom on the path of column j. The sweep that finds them
/// enters them in the order in which products read them: columns that are written together are side by side. Projections off the paths stay zero.
template <class S>
class ColumnProjections {
 public:
  enum Product { by_q, by_v, products };

  void layOut(const CompactImpl& m, Arena& arena) {
    arena.take(columns_, static_cast<std::size_t>(m.nvx));
    const auto inOrder = [&](auto&& use) {
      std::ptrdiff_t used = 0;
      for (const DofChain& chain : m.chains)
        inColumns<S>(chain, [&](auto columns, int j) {
          use(columns, j, used);
          used += products * columns * pathLength(m, j + columns - 1);
        });
      return used;
    };
    S* first = nullptr;
    arena.take(first, static_cast<std::size_t>(inOrder([](int, int, std::ptrdiff_t) {})));
    if (!first) return;
    inOrder([&](int columns, int j, std::ptrdiff_t used) {
      for (int c = 0; c < columns; ++c) columns_[j + c] = {first + used + products * c, products * columns};
    });
  }

  struct Column {
    S* first;
    std::ptrdiff_t stride;
    /// The projections of the degree of freedom at `depth` on the path; those of the next ones are `stride` apart.
    S* at(int depth) const { return first + stride * depth; }
  };
  const Column& operator[](int j) const { return columns_[j]; }

 private:
  Column* columns_ = nullptr;
};

}  // namespace dyn::kernels
