// Products with the factors of M^-1 = U^T D^-1 U of many states at once, a pack of states being a number: what has come up the tree goes down again.
#pragma once

#include "kernels/column_shares.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Rows that are written together.
constexpr int rows_abreast = 4;

/// Of rows_abreast rows each; the last one may have fewer.
constexpr int panelsOf(int rows) { return (rows + rows_abreast - 1) / rows_abreast; }

/// What products take beside their factors and their results.
template <class S>
struct ProductScratch {
  struct Step {
    int dof;
    const S* U;  ///< its row
  };
  Step* paths;    ///< chain by chain the path to the root of the last degree of freedom, root first
  int* reaching;  ///< chain by chain, by panel: how many on the path, from the root on, have some of its rows in their subtrees
  S* shares;      ///< of each on a path U(k, j) / D(k), for some columns j

  void carve(const CompactImpl& m, Arena& arena) {
    std::size_t steps = 0;
    for (const DofChain& chain : m.chains) steps += static_cast<std::size_t>(lengthOf(chain));
    arena.take(paths, steps);
    arena.take(reaching, m.chains.size() * static_cast<std::size_t>(panelsOf(m.nvx)));
    arena.take(shares, static_cast<std::size_t>(columns_abreast<S> * m.path_room));
  }
  void prepare(const CompactImpl& m, const TreeFactors<S>& f) {
    Step* path = paths;
    int* reached = reaching;
    for (const DofChain& chain : m.chains) {
      const int length = lengthOf(chain);
      Step* step = path + length;
      alongPath(m, chain.end - 1, [&](int k) { *--step = {k, f.U[k]}; });
      // Subtrees on the way contain one another: those with a part of a panel are the first ones.
      int some = 0;
      for (int first = 0; first < m.nvx; first += rows_abreast) {
        const auto reaches = [&](int k) { return k < first + rows_abreast && first < m.dof_end[static_cast<std::size_t>(k)]; };
        while (some < length && reaches(path[some].dof)) ++some;
        while (some > 0 && !reaches(path[some - 1].dof)) --some;
        *reached++ = some;
      }
      path += length;
    }
  }
  /// Of its last degree of freedom's path.
  static int lengthOf(const DofChain& chain) { return chain.depth + chain.end - chain.begin; }
};

/// The columns of a product that belong to one chain.
template <class S>
class ChainProduct {
 public:
  using Step = typename ProductScratch<S>::Step;
  ChainProduct(const DofChain& chain, int rows, const S* inverse, const Step* path, const int* reaching, S* shares)
      : chain_(chain), rows_(rows), inverse_(inverse), path_(path), reaching_(reaching), shares_(shares) {}

  /// Degrees of freedom on the path of column j.
  int pathOf(int j) const { return chain_.depth + j - chain_.begin + 1; }

  /// Of the columns of U from j on, what each on their path takes of them.
  template <int columns>
  const S* sharesOfU(int j) const {
    const Step* const path = path_;
    S* share = shares_;
    for (int t = 0, length = pathOf(j + columns - 1); t < length; ++t, share += columns) {
      const S scale = inverse_[path[t].dof];
      const S* const U = path[t].U + j;
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) share[c] = scale * U[c];
    }
    return shares_;
  }

  /// Columns of which `length` on their path, from the root on, take shares, every `every`-th number from `shares` on; into columns that are `stride`
  /// apart from `out` on, their rows from the panel on that has row `first`.
  template <int columns, int every>
  void write(int first, int length, const S* const shares, S* const out, const std::ptrdiff_t stride) const {
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
        const S *const share = shares + every * columns * t, *const U = path[t].U + row;
        each([&](S& x, int c, int r) { use(x, share[every * c], U[r]); });
      };
      if (reaching == 0) {
        each([](S& x, int, int) { x = S(0); });
      } else {
        at(0, [](S& x, const S& share, const S& u) { x = share * u; });
        for (int t = 1; t < reaching; ++t) at(t, [](S& x, const S& share, const S& u) { x += share * u; });
      }
      each([&](const S& x, int c, int r) { out[c * stride + row + r] = x; });
    };
    const int whole = rows_ / rows_abreast;
    for (int p = first / rows_abreast; p < whole; ++p)
      panel(std::integral_constant<int, rows_abreast>(), p * rows_abreast, std::min(length, reaching_[p]));
    withConstant<rows_abreast - 1>(rows_ % rows_abreast, [&](auto rows) { panel(rows, whole * rows_abreast, std::min(length, reaching_[whole])); });
  }

 private:
  const DofChain chain_;
  const int rows_;
  const S* inverse_;
  const Step* path_;
  const int* reaching_;
  S* shares_;
};

/// Calls use.operator()<columns>(product, j) for all columns, those from j on that are written together.
template <class S, class Use>
void inChains(const CompactImpl& m, const TreeFactors<S>& f, const ProductScratch<S>& scratch, Use&& use) {
  const auto* path = scratch.paths;
  const int* reaching = scratch.reaching;
  for (const DofChain& chain : m.chains) {
    const ChainProduct<S> product(chain, m.nvx, f.inverse, path, reaching, scratch.shares);
    inColumns<S>(chain, [&](auto columns, int j) { use.template operator()<columns>(product, j); });
    path += scratch.lengthOf(chain);
    reaching += panelsOf(m.nvx);
  }
}

}  // namespace dyn::kernels
