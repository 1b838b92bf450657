// Products with the factors of M^-1 = U^T D^-1 U: what has come up the tree goes down again.
#pragma once

#include "kernels/tile.hpp"
#include "kernels/tree_factors.hpp"

namespace dyn::kernels {

/// What the columns of a product begin with.
struct FromZeros {
  template <class Tile>
  Tile tile(int, int) const {
    return Tile();
  }
};
/// The other sign of what `below` has: row j for a column's degree of freedom j and its subtree, with that of its whole joint.
template <class S>
struct FromMinus {
  const CompactImpl& m;
  Rows<S> below;

  template <class Tile>
  Tile tile(int j, int first) const {
    const auto beginOf = [&](int dof) { return m.index[static_cast<std::size_t>(m.dof_body[static_cast<std::size_t>(dof)])].idx_v; };
    // Where packs are states, rows have something else's entries before those.
    constexpr bool states = Tile::width == 1;
    if (states && first + Tile::packs <= beginOf(j)) return Tile();
    Tile tile(below[j] + first, below.stride);
    tile.negate();
    if (states && first < beginOf(j + Tile::rows - 1)) {
#pragma GCC unroll 8
      for (int r = 0; r < Tile::rows; ++r) {
        const int begin = beginOf(j + r);
        // From a place that is not constant on, the tile would be built in memory.
#pragma GCC unroll 4
        for (int p = 0; p < Tile::packs; ++p)
          if (first + p < begin) tile.sum[r][p] = {};
      }
    }
    return tile;
  }
};

/// Where the columns of a product go: all of a matrix, in its place.
template <class S>
struct Whole {
  Rows<S> matrix;

  Rows<S> from(int begin) const { return {matrix[begin], matrix.stride}; }
  void written(int, int) const {}
};
/// A few at a time, in a place of theirs, from where put(begin, count) takes them.
template <class S, class Put>
struct InTurn {
  Rows<S> place;
  Put put;

  Rows<S> from(int) const { return place; }
  void written(int begin, int count) const { put(begin, count); }
};

/// Column j of a product, for each degree of freedom j: numbers i of `begin`, and with them, for each k whose subtree has both i and j,
/// U(k, i) / D(k) right(k, j). Of `upper` columns only i >= j, and packs' ends. Columns have room for a pack behind the last one. O(n^2 depth)
/// at most.
template <class Wide, bool upper, class S, class Begin, class Out>
__attribute__((flatten)) void downTheTree(const CompactImpl& m, const TreeFactors<S> f, const Rows<S> right, const Begin start, const Out out) {
  constexpr int width = Part<Wide, S>::width;
  const auto endOf = [&](int dof) { return m.dof_end[static_cast<std::size_t>(dof)]; };
  for (const DofChain& chain : m.chains)
    inBlocks(chain.begin, chain.end, [&]<int rows>(std::integral_constant<int, rows>, int begin) {
      const Rows<S> columns = out.from(begin);
      inPanels<Wide, S, packs_beside<Wide, rows>>(upper ? begin / width * width : 0, m.nvx, [&](auto packs, int first) {
        const int end = first + packs * width;
        auto own = start.template tile<Tile<Wide, S, rows, packs>>(begin, first);
        if (first < endOf(begin) && end > begin)
          [&]<int... k>(std::integer_sequence<int, k...>) {
            (own.template addFrom<k>(f.U[begin + k] + first, f.inverse[begin + k], right[begin + k] + begin), ...);
          }(std::make_integer_sequence<int, rows>());
        // Subtrees on the way contain one another: from the first one with a part of the panel on, all have it.
        int k = m.dof_parent[static_cast<std::size_t>(begin)];
        while (k >= 0 && (first >= endOf(k) || end <= k)) k = m.dof_parent[static_cast<std::size_t>(k)];
        alongPath(m, k, [&](int above) { own.template addFrom<0>(f.U[above] + first, f.inverse[above], right[above] + begin); });
        own.store(columns.first + first, columns.stride);
      });
      out.written(begin, rows);
    });
}

}  // namespace dyn::kernels
