// SPDX-License-Identifier: BSD-2-Clause
// Products with the factors of M^-1 = U^T D^-1 U of many states at once, where a number is a pack of states: the pass down the tree.
#pragma once

#include "kernels/derivative/column_projections.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Rows that are written together.
constexpr int rows_together = 4;

/// The number of panels of rows_together rows each; the last one may have fewer.
constexpr int panelsOf(int rows) { return (rows + rows_together - 1) / rows_together; }

/// Scratch memory of products.
template <class S>
struct ProductScratch {
  struct Step {
    int dof;
    const S* U;  ///< row `dof` of U
  };
  Step* paths;     ///< by chain: the root path of its last degree of freedom, root first
  int* reaching;   ///< by chain and panel: how many on the path, from the root on, have some rows of the panel in their subtrees
  S* projections;  ///< U(k, j) / D(k) for each k on a path and some columns j

  void layOut(const CompactImpl& m, Arena& arena) {
    std::size_t steps = 0;
    for (const DofChain& chain : m.chains) steps += static_cast<std::size_t>(lengthOf(chain));
    arena.take(paths, steps);
    arena.take(reaching, m.chains.size() * static_cast<std::size_t>(panelsOf(m.nvx)));
    arena.take(projections, static_cast<std::size_t>(columns_together<S> * m.path_room));
  }
  void prepare(const CompactImpl& m, const TreeFactors<S>& f) {
    Step* path = paths;
    int* reached = reaching;
    for (const DofChain& chain : m.chains) {
      const int length = lengthOf(chain);
      Step* step = path + length;
      alongPath(m, chain.end - 1, [&](int k) { *--step = {k, f.U[k]}; });
      // Subtrees on the root path contain one another: those that reach into a panel are the first ones, counted from the root.
      int some = 0;
      for (int first = 0; first < m.nvx; first += rows_together) {
        const auto reaches = [&](int k) { return k < first + rows_together && first < m.dof_end[static_cast<std::size_t>(k)]; };
        while (some < length && reaches(path[some].dof)) ++some;
        while (some > 0 && !reaches(path[some - 1].dof)) --some;
        *reached++ = some;
      }
      path += length;
    }
  }
  /// The length of the path of the chain's last degree of freedom.
  static int lengthOf(const DofChain& chain) { return chain.depth + chain.end - chain.begin; }
};

/// The columns of a product that belong to one chain.
template <class S>
class ChainProduct {
 public:
  using Step = typename ProductScratch<S>::Step;
  ChainProduct(const DofChain& chain, int rows, const S* inverse, const Step* path, const int* reaching, S* projections)
      : chain_(chain), rows_(rows), inverse_(inverse), path_(path), reaching_(reaching), projections_(projections) {}

  /// The number of degrees of freedom on the path of column j.
  int pathOf(int j) const { return chain_.depth + j - chain_.begin + 1; }

  /// U(k, c) / D(k) for the `columns` columns c of U from j on and each k on their path.
  template <int columns>
  const S* projectionsOfU(int j) const {
    const Step* const path = path_;
    S* projection = projections_;
    for (int t = 0, length = pathOf(j + columns - 1); t < length; ++t, projection += columns) {
      const S scale = inverse_[path[t].dof];
      const S* const U = path[t].U + j;
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) projection[c] = scale * U[c];
    }
    return projections_;
  }

  /// Writes `columns` columns, which are `stride` apart from `out` on, from the panel on that has row `first`. The first `length` degrees of freedom
  /// of the path, counted from the root, have projections: that of the t-th for column c is projections[every * (columns * t + c)].
  template <int columns, int every>
  void write(int first, int length, const S* const projections, S* const out, const std::ptrdiff_t stride) const {
    const Step* const path = path_;
    const auto panel = [&]<int rows>(std::integral_constant<int, rows>, int row, int reaching) {
      S sum[columns][rows];
      const auto each = [&](auto&& use) {
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r)
#pragma GCC unroll 6
          for (int c = 0; c < columns; ++c) use(sum[c][r], c, r);
      };
      const auto at = [&](int t, auto&& use) {
        const S *const projection = projections + every * columns * t, *const U = path[t].U + row;
        each([&](S& x, int c, int r) { use(x, projection[every * c], U[r]); });
      };
      if (reaching == 0) {
        each([](S& x, int, int) { x = S(0); });
      } else {
        at(0, [](S& x, const S& projection, const S& u) { x = projection * u; });
        for (int t = 1; t < reaching; ++t) at(t, [](S& x, const S& projection, const S& u) { x += projection * u; });
      }
      each([&](const S& x, int c, int r) { out[c * stride + row + r] = x; });
    };
    const int whole = rows_ / rows_together;
    for (int p = first / rows_together; p < whole; ++p)
      panel(std::integral_constant<int, rows_together>(), p * rows_together, std::min(length, reaching_[p]));
    withConstant<rows_together - 1>(rows_ % rows_together,
                                    [&](auto rows) { panel(rows, whole * rows_together, std::min(length, reaching_[whole])); });
  }

 private:
  const DofChain chain_;
  const int rows_;
  const S* inverse_;
  const Step* path_;
  const int* reaching_;
  S* projections_;
};

/// Calls use.operator()<columns>(product, j) for each set of columns that are written together, from j on.
template <class S, class Use>
void inChains(const CompactImpl& m, const TreeFactors<S>& f, const ProductScratch<S>& scratch, Use&& use) {
  const auto* path = scratch.paths;
  const int* reaching = scratch.reaching;
  for (const DofChain& chain : m.chains) {
    const ChainProduct<S> product(chain, m.nvx, f.inverse, path, reaching, scratch.projections);
    inColumns<S>(chain, [&](auto columns, int j) { use.template operator()<columns>(product, j); });
    path += scratch.lengthOf(chain);
    reaching += panelsOf(m.nvx);
  }
}

}  // namespace dyn::kernels
