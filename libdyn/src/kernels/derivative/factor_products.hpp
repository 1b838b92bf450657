// SPDX-License-Identifier: BSD-2-Clause
// Products of vectors and matrices with the factors of M that follow the tree (cholesky.hpp).
#pragma once

#include "kernels/derivative/cholesky.hpp"

namespace dyn::kernels {

/// Factors beside a pack Wide of numbers S: neighbouring ones, or one for all lanes where the lanes of S are columns.
template <class Wide, class S, class F>
Wide factorsBeside(const F* from) {
  if constexpr (lanes_of<Wide> == lanes_of<S>) {
    return Wide(*from);
  } else {
    return Wide::load(from);
  }
}

/// x = L^-T x, or L^T x, then divided by D or multiplied with `factor` if that is not null. A subtree's rows add to its path by way of `sums`, by
/// depth, which are zero before and after. Chains are taken in blocks of constant size, and paths in whole packs and a few numbers. Numbers are read
/// as they were written, in packs or one by one: a core waits where a pack is read whose numbers have just been written. Each row takes the number
/// that was found last at its end, so that from row to row it takes only one product and a difference. S is a number, or a pack of columns.
template <bool inverse, class Wide, class S, class F>
void timesUpper(const CompactImpl& m, const PathFactors<F>& c, const F* factor, S* sums, S* x) {
  constexpr int width = Part<Wide, S>::width;
  const S sign(inverse ? -1 : 1);
  for (auto chain = m.chains.rbegin(); chain != m.chains.rend(); ++chain)
    inBlocksBackward(chain->begin, chain->end, [&](auto n, int begin) {
      constexpr int count = n;
      const int depth = chain->depth + begin - chain->begin, whole = depth / width * width;
      const Rows<F> rows{c.L[begin], c.L.stride};
      S given[count], own[count];
#pragma GCC unroll 8
      for (int k = 0; k < count; ++k) {
        given[k] = x[begin + k];
        own[k] = given[k] - sign * sums[depth + k];
        sums[depth + k] = S(0);
      }
#pragma GCC unroll 8
      for (int row = count - 1; row >= 0; --row)
#pragma GCC unroll 8
        for (int k = count - 1; k > row; --k) own[row] += sign * (S(rows[k][depth + row]) * (inverse ? own[k] : given[k]));
      for (int first = 0; first < whole; first += width) {
        Wide packs = loadPack<Wide>(sums + first);
#pragma GCC unroll 8
        for (int k = 0; k < count; ++k) packs -= Wide(inverse ? own[k] : given[k]) * factorsBeside<Wide, S>(rows[k] + first);
        storePack(packs, sums + first);
      }
      for (int at = whole; at < depth; ++at) {
        S sum = sums[at];
#pragma GCC unroll 8
        for (int k = 0; k < count; ++k) sum -= (inverse ? own[k] : given[k]) * S(rows[k][at]);
        sums[at] = sum;
      }
#pragma GCC unroll 8
      for (int k = 0; k < count; ++k) x[begin + k] = factor ? own[k] * S(factor[begin + k]) : own[k];
    });
}

/// x = L^-1 x, or L x. `path`: scratch for the numbers of a path. Blocks, packs, the order of sums and S are as in timesUpper().
template <bool inverse, class Wide, class S, class F>
void timesLower(const CompactImpl& m, const PathFactors<F>& c, const F* factor, S* path, S* x) {
  constexpr int width = Part<Wide, S>::width;
  const S sign(inverse ? -1 : 1);
  for (const DofChain& chain : m.chains)
    inBlocks(chain.begin, chain.end, [&](auto n, int begin) {
      constexpr int count = n;
      const int depth = chain.depth + begin - chain.begin, whole = depth / width * width;
      const Rows<F> rows{c.L[begin], c.L.stride};
      Wide packs[count];
      S given[count], own[count];
#pragma GCC unroll 8
      for (int row = 0; row < count; ++row) {
        packs[row] = Wide(0);
        own[row] = given[row] = x[begin + row];
      }
      for (int first = 0; first < whole; first += width) {
        const Wide numbers = loadPack<Wide>(path + first);
#pragma GCC unroll 8
        for (int row = 0; row < count; ++row) packs[row] += factorsBeside<Wide, S>(rows[row] + first) * numbers;
      }
      for (int at = whole; at < depth; ++at)
#pragma GCC unroll 8
        for (int row = 0; row < count; ++row) own[row] += sign * (S(rows[row][at]) * path[at]);
      if (whole > 0) {
#pragma GCC unroll 8
        for (int row = 0; row < count; ++row) own[row] += sign * total<S>(packs[row]);
      }
#pragma GCC unroll 8
      for (int row = 0; row < count; ++row)
#pragma GCC unroll 8
        for (int k = 0; k < row; ++k) own[row] += sign * (S(rows[row][depth + k]) * (inverse ? own[k] : given[k]));
#pragma GCC unroll 8
      for (int k = 0; k < count; ++k) {
        path[depth + k] = inverse ? own[k] : given[k];
        x[begin + k] = factor ? own[k] * S(factor[begin + k]) : own[k];
      }
    });
}

/// x = M^-1 x, M x, L^T x or L x, in place of nvx numbers, or nvx packs of columns. `path`: scratch, path_room numbers with room for a pack, or
/// packs. O(n depth).
template <class Wide, class S, class F>
void factorTimes(const CompactImpl& m, const PathFactors<F>& c, FactorProduct product, S* path, S* x) {
  constexpr const F* none = nullptr;
  const auto upper = [&]<bool inverse>(const F* factor) {
    std::fill(path, path + m.path_room, S(0));
    timesUpper<inverse, Wide>(m, c, factor, path, x);
  };
  switch (product) {
    case FactorProduct::inverse:
      upper.template operator()<true>(c.inverse);
      return timesLower<true, Wide>(m, c, none, path, x);
    case FactorProduct::mass_matrix:
      timesLower<false, Wide>(m, c, c.diagonal, path, x);
      return upper.template operator()<false>(none);
    case FactorProduct::upper:
      return upper.template operator()<false>(none);
    case FactorProduct::lower:
      return timesLower<false, Wide>(m, c, none, path, x);
  }
}

/// The same in place of `count` columns, `stride` numbers apart. The lanes of Columns hold as many columns as it has.
template <class Wide, class Columns>
void factorTimesColumns(const CompactImpl& m, const PathFactors<double>& c, FactorProduct product, double* first, std::ptrdiff_t count,
                        std::ptrdiff_t stride) {
  constexpr std::ptrdiff_t lanes = lanes_of<Columns>;
  auto* packs = reinterpret_cast<Columns*>(c.columns);
  while (count > 0) {
    const std::ptrdiff_t now = std::min(lanes, count);
    count -= now;
    if (now == 1) {
      factorTimes<Wide>(m, c, product, c.path[0], first);
    } else {
      loadColumns(ColumnsIn<double>{first, stride, static_cast<int>(now), static_cast<int>(count)}, m.nvx, packs);
      factorTimes<Columns>(m, c, product, packs + m.nvx, packs);
      (void)storeColumns(packs, m.nvx, static_cast<int>(now), first, stride);
    }
    first += now * stride;
  }
}

}  // namespace dyn::kernels
