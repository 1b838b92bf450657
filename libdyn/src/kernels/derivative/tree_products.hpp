// SPDX-License-Identifier: BSD-2-Clause
// Products with the factors of M^-1 = U^T D^-1 U of one state: the pass down the tree.
#pragma once

#include "kernels/derivative/tile.hpp"
#include "kernels/derivative/tree_factors.hpp"

namespace dyn::kernels {

/// The columns of a product start from zeros.
struct FromZeros {
  template <class Tile>
  Tile tile(int, int) const {
    return Tile();
  }
};
/// The columns of a product start from -below: row j of `below` has the entries of column j for the subtree of j's joint.
template <class S>
struct FromMinus {
  Rows<S> below;

  template <class Tile>
  Tile tile(int j, int first) const {
    Tile tile(below[j] + first, below.stride);
    tile.negate();
    return tile;
  }
};

/// Writes column j of a product for each degree of freedom j: entry i is start(i, j) + sum_k U(k, i) / D(k) right(k, j) over the k whose subtrees
/// have both i and j. If `upper`, it writes only i >= j, and the rest of packs. There must be room for a pack behind the last column. O(n^2 depth)
/// at most.
template <class Wide, bool upper, class S, class Begin>
__attribute__((flatten)) void downTheTree(const CompactImpl& m, const TreeFactors<S> f, const Rows<S> right, const Begin start, const Rows<S> out) {
  constexpr int width = Part<Wide, S>::width;
  const auto endOf = [&](int dof) { return m.dof_end[static_cast<std::size_t>(dof)]; };
  for (const DofChain& chain : m.chains)
    inBlocks(chain.begin, chain.end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      inPanels<Wide, S, packs_beside<Wide, rows>>(upper ? begin / width * width : 0, m.nvx, [&](auto packs, int first) {
        const int end = first + packs * width;
        auto own = start.template tile<Tile<Wide, S, rows, packs>>(begin, first);
        if (first < endOf(begin) && end > begin)
          [&]<int... k>(std::integer_sequence<int, k...>) {
            (own.template addFrom<k>(f.U[begin + k] + first, f.inverse[begin + k], right[begin + k] + begin), ...);
          }(std::make_integer_sequence<int, rows>());
        // Subtrees on the root path contain one another: from the first one that reaches into the panel on, all do.
        int k = m.dof_parent[static_cast<std::size_t>(begin)];
        while (k >= 0 && (first >= endOf(k) || end <= k)) k = m.dof_parent[static_cast<std::size_t>(k)];
        alongPath(m, k, [&](int above) { own.template addFrom<0>(f.U[above] + first, f.inverse[above], right[above] + begin); });
        own.store(out[begin] + first, out.stride);
      });
    });
}

}  // namespace dyn::kernels
