// What products of many states at once, a pack of states being a number, read of their right sides.
#pragma once

#include "kernels/tile.hpp"
#include "kernels/tree_factors.hpp"

#include <cstddef>

namespace dyn::kernels {

/// Columns that are written together: beside as many sums, of four rows each, a number of U and the columns' shares fit into registers.
template <class S>
constexpr int columns_abreast = sizeof(S) == 64 ? 6 : 3;

/// Calls use(columns, j) for those of a chain that are written together, from j on; `columns` is a constant.
template <class S, class Use>
void inColumns(const DofChain& chain, Use&& use) {
  inBlocks<columns_abreast<S>>(chain.begin, chain.end, use);
}

/// Of two products M^-1 x: the shares right(k, j) / D(k) that the degrees of freedom on its path take of column j before it goes down the tree.
/// The sweep that finds them enters them where products read them, one after the other: columns that are written together are side by side. Others
/// than those on paths stay zero.
template <class S>
class ColumnShares {
 public:
  enum Product { by_q, by_v, products };

  void carve(const CompactImpl& m, Arena& arena) {
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
    /// Those of the one on its path that has `depth` others before it; of the next ones `stride` apart.
    S* at(int depth) const { return first + stride * depth; }
  };
  const Column& operator[](int j) const { return columns_[j]; }

 private:
  Column* columns_ = nullptr;
};

}  // namespace dyn::kernels
