// Products with the factors of M^-1 = U^T D^-1 U of many states at once, a pack of states being a number: what has come up the tree goes down again.
#pragma once

#include "kernels/path_pairs.hpp"
#include "kernels/tile.hpp"
#include "kernels/tree_factors.hpp"

namespace dyn::kernels {

/// Columns and rows that are written together: beside as many sums a number of U and the columns' shares fit into registers.
template <class S>
constexpr int columns_abreast = sizeof(S) == 64 ? 6 : 3;
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
  S* shares;      ///< of each on a path right(k, j) / D(k), for some columns j

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

  /// The row of U of the one on the columns' paths that has `depth` others before it.
  const S* factor(int depth) const { return path_[depth].U; }
  /// Columns j and the next ones, with right(c, depth) of the c-th and what is on its path; rows from the panel on that has row `first`.
  /// start(sum, row) says what the columns begin with from `row` on, take(sum, row) what they are.
  template <int columns, class Right, class Start, class Take>
  [[gnu::flatten]] void write(int j, int first, const Right right, const Start start, const Take take) const {
    const int before = chain_.depth + j - chain_.begin, length = before + columns;
    const Step* const path = path_;
    const S* const inverse = inverse_;
    S* const shares = shares_;
    for (int t = 0; t <= before; ++t) {
      const S& scale = inverse[path[t].dof];
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c) shares[t * columns + c] = scale * right(c, t);
    }
    // Later columns' own are not on the paths of those before.
    for (int own = 1; own < columns; ++own) {
      const int t = before + own;
      const S& scale = inverse[path[t].dof];
      for (int c = 0; c < columns; ++c) shares[t * columns + c] = c < own ? S(0) : scale * right(c, t);
    }
    const auto panel = [&]<int rows>(std::integral_constant<int, rows>, int row, int reaching) {
      S sum[columns][rows];
      start(sum, row);
      const S* share = shares;
      for (int t = 0; t < reaching; ++t, share += columns) {
        const S* const U = path[t].U + row;
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r)
#pragma GCC unroll 6
          for (int c = 0; c < columns; ++c) sum[c][r] += share[c] * U[r];
      }
      take(sum, row);
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
    inBlocks<columns_abreast<S>>(chain.begin, chain.end, [&](auto columns, int j) { use.template operator()<columns>(product, j); });
    path += scratch.lengthOf(chain);
    reaching += panelsOf(m.nvx);
  }
}

template <int columns, int rows, class S>
void setZero(S (&sum)[columns][rows]) {
#pragma GCC unroll 6
  for (int c = 0; c < columns; ++c)
#pragma GCC unroll 4
    for (int r = 0; r < rows; ++r) sum[c][r] = S(0);
}
/// Columns from j on with the other sign of what pairs have below the diagonal, and of each whole joint.
template <class S, int columns>
class OtherSign {
 public:
  OtherSign(const CompactImpl& m, const PathPairs<S>& pairs, typename PathPairs<S>::Number below, int j)
      : pairs_(pairs), below_(below), depth_(m.dof_depth[static_cast<std::size_t>(j)]), end_(m.dof_end[static_cast<std::size_t>(j)]) {
    for (int c = 0; c < columns; ++c) begin_[c] = m.index[static_cast<std::size_t>(m.dof_body[static_cast<std::size_t>(j + c)])].idx_v;
  }
  template <int rows>
  void operator()(S (&sum)[columns][rows], int first) const {
    if (first + rows <= begin_[0] || first >= end_) return setZero(sum);
    const auto fill = [&](const auto& has) {
#pragma GCC unroll 4
      for (int r = 0; r < rows; ++r) {
        const S* const numbers = pairs_.row(first + r, depth_) + below_;
#pragma GCC unroll 6
        for (int c = 0; c < columns; ++c) sum[c][r] = has(c, first + r) ? -numbers[PathPairs<S>::numbers * c] : S(0);
      }
    };
    if (begin_[columns - 1] <= first && first + rows <= end_) return fill([](int, int) { return true; });
    fill([&](int c, int row) { return begin_[c] <= row && row < end_; });
  }

 private:
  const PathPairs<S> pairs_;
  const int below_, depth_, end_;
  int begin_[columns];
};

}  // namespace dyn::kernels
