// The factors of M that follow the tree: M = L^T D L, L unit lower triangular with entries only for degrees of freedom on one path to the
// root (Featherstone 2005, "Efficient factorization of the joint-space inertia matrix for branched kinematic trees").
//
// Rows are as long as their paths: entry c is that of the path's degree of freedom of depth c. What goes from row to row goes by way of
// depths, and nobody looks for ancestors: from the last degree of freedom to the first, all of a subtree has its turn between its root and
// the next one of the root's depth; from the first to the last, the last ones of each lesser depth are the path.
#pragma once

#include "kernels/pivots.hpp"
#include "kernels/tile.hpp"

namespace dyn::kernels {

template <class S>
struct PathFactors {
  Rows<S> L;              ///< row i: the entries of i's path but i itself, by depth
  Rows<S> path;           ///< rows by depth [scratch]
  S* diagonal = nullptr;  ///< D
  S* inverse = nullptr;   ///< 1 / D
};

template <class S>
void carve(PathFactors<S>& c, const CompactImpl& m, Arena& arena) {
  arena.take(c.L, m.nvx, m.path_room);
  arena.take(c.path, m.path_room, m.path_room);
  arena.take(c.diagonal, static_cast<std::size_t>(m.nvx));
  arena.take(c.inverse, static_cast<std::size_t>(m.nvx));
}

/// Subtracts from the first `columns` entries of a row, or of zeros, those of `count` other rows times their factors, in packs. Factors are the
/// first numbers of rows, too.
template <class Wide, class S>
void subtractRows(S* row, bool zero, int columns, const Rows<S>& factors, const Rows<S>& rows, int count) {
  inPanels<Wide, S>(0, columns, [&](auto packs, int first) {
    using Row = Tile<Wide, S, 1, packs>;
    Row sum = zero ? Row() : Row(row + first, 0);
    sum.subtract(rows.first + first, rows.stride, count, factors.first, 0, factors.stride);
    sum.store(row + first, 0);
  });
}

/// Adds what M, n x n with room for a pack, has of the rows of a chain to those of `path`, or puts it there: each piece of the path that has
/// no gap in the numbers lies side by side.
template <class Wide, bool put, class S>
void addPaths(const CompactImpl& m, const DofChain& chain, const S* M, const Rows<S>& path) {
  constexpr int width = Part<Wide, S>::width;
  for (int last = chain.begin; last >= 0;) {
    const int first = m.dof_segment[static_cast<std::size_t>(last)], depth = m.dof_depth[static_cast<std::size_t>(first)];
    const bool own = last == chain.begin;
    for (int i = chain.begin; i < chain.end; ++i) {
      const int count = (own ? i : last) + 1 - first;
      const S* from = M + static_cast<std::ptrdiff_t>(m.nvx) * i + first;
      S* to = path[chain.depth + i - chain.begin] + depth;
      int k = 0;
      // Beyond the diagonal are numbers that nobody reads.
      for (; own ? k < count : k + width <= count; k += width)
        storePack(put ? loadPack<Wide>(from + k) : loadPack<Wide>(to + k) + loadPack<Wide>(from + k), to + k);
      for (; k < count; ++k) to[k] = put ? from[k] : to[k] + from[k];
    }
    last = m.dof_parent[static_cast<std::size_t>(first)];
  }
}

/// Of M, n x n with room for a pack, symmetric. Notes in `failed`, lane by lane, the first degree of freedom, plus one, whose pivot is not
/// above the rounding of what it was subtracted from. O(n depth^2).
template <class Wide, class S>
__attribute__((flatten)) void choleskyDecompose(const CompactImpl& m, const S* M, PathFactors<S>& c, int* failed) {
  constexpr int width = Part<Wide, S>::width;
  std::fill(failed, failed + lanes_of<S>, 0);
  for (auto chain = m.chains.rbegin(); chain != m.chains.rend(); ++chain) {
    const int count = chain->end - chain->begin;
    if (chain->leaf) {
      addPaths<Wide, true>(m, *chain, M, c.path);
    } else {
      addPaths<Wide, false>(m, *chain, M, c.path);
    }
    const Rows<S> factors{c.L[chain->begin], c.L.stride}, rows{c.path[chain->depth], c.path.stride};
    S inverse(0);
    for (int k = count - 1; k >= 0; --k) {
      const int i = chain->begin + k, depth = chain->depth + k;
      S* row = c.path[depth];
      // The pivot by itself, from numbers at hand: the next ones wait for it.
      S pivot = row[depth];
      for (int l = count - 1; l > k + 1; --l) pivot -= factors[l][depth] * rows[l][depth];
      if (k < count - 1) pivot -= inverse * rows[k + 1][depth] * rows[k + 1][depth];
      subtractRows<Wide>(row, false, depth, Rows<S>{factors[k + 1] + depth, factors.stride}, Rows<S>{rows[k + 1], rows.stride}, count - 1 - k);
      noteSmall(pivot, S(8 * std::numeric_limits<Real<S>>::epsilon()) * M[static_cast<std::ptrdiff_t>(m.nvx + 1) * i], i + 1, failed);
      inverse = S(1) / pivot;
      c.diagonal[i] = pivot;
      c.inverse[i] = inverse;
      for (int first = 0; first < depth; first += width) storePack(Wide(inverse) * loadPack<Wide>(row + first), c.L[i] + first);
    }
    for (int depth = 0; depth < chain->depth; ++depth)
      subtractRows<Wide>(c.path[depth], depth >= chain->fresh, depth + 1, Rows<S>{factors[0] + depth, factors.stride}, rows, count);
  }
}

enum class FactorProduct { inverse, mass_matrix, upper, lower };

/// x = L^-T x, or L^T x. What a subtree's rows send to its path goes by way of `sums`, by depth, which are zero before and after.
template <bool inverse, class Wide, class S>
void timesUpper(const CompactImpl& m, const PathFactors<S>& c, S* sums, S* x) {
  constexpr S sign(inverse ? -1 : 1);
  for (auto chain = m.chains.rbegin(); chain != m.chains.rend(); ++chain) {
    const int count = chain->end - chain->begin, packed = chain->depth / Part<Wide, S>::width * Part<Wide, S>::width;
    S* own = x + chain->begin;
    const Rows<S> rows{c.L[chain->begin], c.L.stride};
    const auto gather = [&](int row) {
      S sum = sums[chain->depth + row];
      sums[chain->depth + row] = S(0);
      for (int k = row + 1; k < count; ++k) sum -= rows[k][chain->depth + row] * own[k];
      own[row] -= sign * sum;
    };
    if (inverse)
      for (int row = count - 1; row >= 0; --row) gather(row);
    subtractRows<Wide>(sums, false, packed, Rows<S>{own, 1}, rows, count);
    for (int k = 0; k < count; ++k)
      for (int depth = packed; depth < chain->depth; ++depth) sums[depth] -= rows[k][depth] * own[k];
    if (!inverse)
      for (int row = 0; row < count; ++row) gather(row);
  }
}

/// x = L^-1 x, or L x. `path`: room for the numbers of a path.
template <bool inverse, class Wide, class S>
void timesLower(const CompactImpl& m, const PathFactors<S>& c, S* path, S* x) {
  constexpr int width = Part<Wide, S>::width;
  for (const DofChain& chain : m.chains) {
    const int count = chain.end - chain.begin;
    S* own = x + chain.begin;
    const auto gather = [&](int row) {
      const S* entries = c.L[chain.begin + row];
      Wide packs(0);
      int depth = 0;
      for (; depth + width <= chain.depth; depth += width) packs += loadPack<Wide>(entries + depth) * loadPack<Wide>(path + depth);
      S sum = total<S>(packs);
      for (; depth < chain.depth; ++depth) sum += entries[depth] * path[depth];
      for (int k = 0; k < row; ++k) sum += entries[chain.depth + k] * own[k];
      own[row] += inverse ? -sum : sum;
    };
    if (inverse)
      for (int row = 0; row < count; ++row) gather(row);
    std::copy(own, own + count, path + chain.depth);
    if (!inverse)
      for (int row = count - 1; row >= 0; --row) gather(row);
  }
}

/// x = M^-1 x, M x, L^T x or L x, in place of nvx numbers. O(n depth).
template <class Wide, class S>
void factorTimes(const CompactImpl& m, const PathFactors<S>& c, FactorProduct product, S* x) {
  S* path = c.path[0];
  const auto upper = [&]<bool inverse>() {
    std::fill(path, path + m.path_room, S(0));
    timesUpper<inverse, Wide>(m, c, path, x);
  };
  if (product == FactorProduct::inverse) upper.template operator()<true>();
  if (product == FactorProduct::mass_matrix || product == FactorProduct::lower) timesLower<false, Wide>(m, c, path, x);
  if (product == FactorProduct::inverse || product == FactorProduct::mass_matrix) {
    const S* factor = product == FactorProduct::inverse ? c.inverse : c.diagonal;
    for (int i = 0; i < m.nvx; ++i) x[i] *= factor[i];
  }
  if (product == FactorProduct::mass_matrix || product == FactorProduct::upper) upper.template operator()<false>();
  if (product == FactorProduct::inverse) timesLower<true, Wide>(m, c, path, x);
}

}  // namespace dyn::kernels
