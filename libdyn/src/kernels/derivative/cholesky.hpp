// SPDX-License-Identifier: BSD-2-Clause
// The factors of M that follow the tree: M = L^T D L, L unit lower triangular with entries only for degrees of freedom on one root path
// (Featherstone 2005, "Efficient factorization of the joint-space inertia matrix for branched kinematic trees").
//
// Rows are as long as their paths: entry c belongs to the path's degree of freedom of depth c. Rows exchange numbers by depth, so no search for
// ancestors is needed. From the last degree of freedom to the first, a whole subtree is visited after the next degree of freedom of its root's depth
// and before its root. From the first to the last, the most recent degrees of freedom of each lesser depth are the path.
#pragma once

#include "kernels/derivative/tile.hpp"
#include "kernels/pack/pivots.hpp"

namespace dyn::kernels {

template <class S>
struct PathFactors {
  Rows<S> L;              ///< row i: the entries of i's path without i itself, by depth
  Rows<S> path;           ///< rows by depth [scratch]
  S* columns = nullptr;   ///< nvx + path_room packs [scratch of products with several columns]
  S* diagonal = nullptr;  ///< D
  S* inverse = nullptr;   ///< 1 / D
};

template <class S>
void layOut(PathFactors<S>& c, const CompactImpl& m, Arena& arena) {
  arena.take(c.L, m.nvx, m.path_room);
  arena.take(c.path, m.path_room, m.path_room);
  arena.take(c.columns, static_cast<std::size_t>(m.nvx + m.path_room) * pack_width<S>);
  arena.take(c.diagonal, static_cast<std::size_t>(m.nvx));
  arena.take(c.inverse, static_cast<std::size_t>(m.nvx));
}

/// Degrees of freedom that are eliminated together: consecutive ones of a chain.
template <class S>
struct Pivots {
  int begin, depth;         ///< of the first one
  bool plain;               ///< nothing has been subtracted from their rows yet
  int first_fresh_depth;    ///< nothing has been subtracted from their path from this depth on
  Rows<const S> own, path;  ///< their rows of M: from the first one on, and by depth
};

/// The first degree of freedom of a chain's path if the chain's rows can be read from M as rows by depth, otherwise -1. They can if the numbers of
/// the path above the chain have no gap, and the chain either follows without a gap or is eliminated in one block.
inline int straightFrom(const CompactImpl& m, const DofChain& chain) {
  const int parent = m.dof_parent[static_cast<std::size_t>(chain.begin)];
  if (parent < 0) return chain.begin;
  const int first = m.dof_segment[static_cast<std::size_t>(parent)];
  const bool one_piece = m.dof_parent[static_cast<std::size_t>(first)] < 0 && (parent == chain.begin - 1 || chain.end - chain.begin <= most_rows);
  return one_piece ? first : -1;
}

/// Copies a chain's rows of M, n x n with room for a pack, to `rows`, by depth. It copies each contiguous run of the path's numbers, the one nearest
/// to the root first, up to the run that ends at `last`. Packs also write beyond a run's end; the next run overwrites these numbers, or nobody reads
/// them.
template <class Wide, class S>
void copyPaths(const CompactImpl& m, const DofChain& chain, int last, const S* M, const Rows<S>& rows) {
  constexpr int width = Part<Wide, S>::width;
  const int first = m.dof_segment[static_cast<std::size_t>(last)], above = m.dof_parent[static_cast<std::size_t>(first)];
  if (above >= 0) copyPaths<Wide>(m, chain, above, M, rows);
  const int end = last == chain.begin ? chain.end : last + 1, depth = m.dof_depth[static_cast<std::size_t>(first)];
  for (int k = 0; k < end - first; k += width)
    for (int i = chain.begin; i < chain.end; ++i)
      storePack(loadPack<Wide>(M + static_cast<std::ptrdiff_t>(m.nvx) * i + first + k), rows[i] + depth + k);
}

/// Eliminates `count` degrees of freedom. Adds the (negative) sums in c.path to their rows, and subtracts from c.path the squares for their path.
/// Products are formed before they are divided by pivots, so that from pivot to pivot it takes only a division and a difference.
template <int count, class Wide, class S>
void eliminate(const Pivots<S>& pivots, const PathFactors<S>& factors, int* failed) {
  constexpr int width = Part<Wide, S>::width;
  // Copies: the compiler must assume that stores of packs may change anything, even the structs that hold the pointers.
  const Pivots<S> p = pivots;
  const PathFactors<S> c = factors;
  const Rows<S> rows{c.L[p.begin], c.L.stride}, sums{c.path[p.depth], c.path.stride};
  S own[count][count], inverse[count];
#pragma GCC unroll 8
  for (int i = 0; i < count; ++i)
#pragma GCC unroll 8
    for (int j = 0; j <= i; ++j) own[i][j] = p.plain ? p.own[i][j] : p.own[i][j] + sums[i][p.depth + j];
#pragma GCC unroll 8
  for (int k = count - 1; k >= 0; --k) {
    inverse[k] = S(1) / own[k][k];
    noteSmall(own[k][k], S(8 * std::numeric_limits<Real<S>>::epsilon()) * p.own[k][k], p.begin + k + 1, failed);
#pragma GCC unroll 8
    for (int i = k - 1; i >= 0; --i)
#pragma GCC unroll 8
      for (int j = i; j >= 0; --j) own[i][j] -= own[k][i] * own[k][j] * inverse[k];
    c.diagonal[p.begin + k] = own[k][k];
    c.inverse[p.begin + k] = inverse[k];
#pragma GCC unroll 8
    for (int j = 0; j < k; ++j) own[k][j] *= inverse[k];
  }
  // The last pack of columns comes first: the sums of a pack need the entries of L in all columns from it on.
  for (int first = (p.depth - 1) / width * width; first >= 0 && p.depth > 0; first -= width) {
    Wide row[count];
#pragma GCC unroll 8
    for (int k = count - 1; k >= 0; --k) {
      row[k] = loadPack<Wide>(p.path[k] + first);
      if (!p.plain) row[k] += loadPack<Wide>(sums[k] + first);
#pragma GCC unroll 8
      for (int l = count - 1; l > k; --l) row[k] -= Wide(own[l][k]) * row[l];
      storePack(Wide(inverse[k]) * row[k], rows[k] + first);
    }
    for (int depth = first; depth < p.depth; ++depth) {
      Wide sum = depth < p.first_fresh_depth ? loadPack<Wide>(c.path[depth] + first) : Wide(0);
#pragma GCC unroll 8
      for (int k = 0; k < count; ++k) sum -= Wide(rows[k][depth]) * row[k];
      storePack(sum, c.path[depth] + first);
    }
  }
#pragma GCC unroll 8
  for (int k = 1; k < count; ++k)
#pragma GCC unroll 8
    for (int j = 0; j < k; ++j) rows[k][p.depth + j] = own[k][j];
}

/// Factorises M, n x n with room for a pack, symmetric. `failed` gets, by lane, one plus the first degree of freedom whose pivot is not above the
/// rounding of its diagonal entry of M, or 0. O(n depth^2).
template <class Wide, class S>
__attribute__((flatten)) void choleskyDecompose(const CompactImpl& m, const S* M, PathFactors<S>& c, int* failed) {
  const std::ptrdiff_t n = m.nvx;
  std::fill(failed, failed + lanes_of<S>, 0);
  // All copies come first: a load that spans several recent stores must wait for them.
  for (auto chain = m.chains.rbegin(); chain != m.chains.rend(); ++chain)
    if (straightFrom(m, *chain) < 0) copyPaths<Wide>(m, *chain, chain->begin, M, c.L);
  for (auto chain = m.chains.rbegin(); chain != m.chains.rend(); ++chain) {
    bool plain = chain->leaf;
    const int first = straightFrom(m, *chain);
    inBlocksBackward(chain->begin, chain->end, [&](auto count, int begin) {
      const Rows<const S> path = first >= 0 ? Rows<const S>{M + n * begin + first, n} : Rows<const S>{c.L[begin], c.L.stride};
      eliminate<count, Wide>(
          {begin, chain->depth + begin - chain->begin, plain, plain ? chain->first_fresh_depth : m.path_room, {M + (n + 1) * begin, n}, path}, c,
          failed);
      plain = false;
    });
  }
}

enum class FactorProduct { inverse, mass_matrix, upper, lower };

}  // namespace dyn::kernels
