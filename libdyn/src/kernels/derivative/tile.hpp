// SPDX-License-Identifier: BSD-2-Clause
// Tiles of a matrix in an elimination: a few packs of a few rows, held in registers.
#pragma once

#include "kernels/order/subtree.hpp"

#include <type_traits>

namespace dyn::kernels {

/// `rows` rows of `packs` packs, to which multiples of other rows are added. All rows are `stride` apart.
template <class Wide, class S, int rows_, int packs_>
struct Tile {
  static constexpr int rows = rows_, packs = packs_;
  static constexpr int width = Part<Wide, S>::width;
  Wide sum[rows][packs];

  /// A tile of zeros.
  Tile() {
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = Wide(0);
  }
  Tile(const S* from, std::ptrdiff_t stride) {
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r, from += stride)
      for (int p = 0; p < packs; ++p) sum[r][p] = loadPack<Wide>(from + p * width);
  }
  /// Subtracts `terms` other rows times factors. The factor of row r and term k is factors[r * by_row + k * by_term].
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* factors, std::ptrdiff_t by_row, std::ptrdiff_t by_term) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r * by_row + k * by_term]; });
  }
  /// The same, where factors[r] points to the factors of row r, one after the other.
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* const (&factors)[rows]) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r][k]; });
  }
  void negate() {
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = -sum[r][p];
  }
  /// Adds another row, times `scale` and times each row's factor, to the rows from `begin` on.
  template <int begin>
  void addFrom(const S* from, const S& scale, const S* factors) {
    Wide other[packs];
    for (int p = 0; p < packs; ++p) other[p] = Wide(scale) * loadPack<Wide>(from + p * width);
#pragma GCC unroll 8
    for (int r = begin; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] += Wide(factors[r]) * other[p];
  }
  void store(S* to, std::ptrdiff_t stride) const {
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r, to += stride)
      for (int p = 0; p < packs; ++p) storePack(sum[r][p], to + p * width);
  }

 private:
  template <class Factor>
  void subtractBy(const S* from, std::ptrdiff_t stride, int terms, Factor&& factorOf) {
    for (int k = 0; k < terms; ++k, from += stride) {
      Wide other[packs];
      for (int p = 0; p < packs; ++p) other[p] = loadPack<Wide>(from + p * width);
#pragma GCC unroll 8
      for (int r = 0; r < rows; ++r) {
        const Wide factor(factorOf(r, k));
        for (int p = 0; p < packs; ++p) sum[r][p] -= factor * other[p];
      }
    }
  }
};

/// Calls use(n) with n, from 1 to `most`, a constant.
template <int most, class Use>
void withConstant(int n, Use&& use) {
  [&]<int... k>(std::integer_sequence<int, k...>) {
    (void)((n == k + 1 && (use(std::integral_constant<int, k + 1>()), true)) || ...);
  }(std::make_integer_sequence<int, most>());
}

/// Calls use(count, first) for the columns [first, end), in panels of `count` packs, a constant of at most `most`. The first two panels differ by at
/// most one pack. The last panel is visited first, so that its stores beyond `end` may hit the beginning of another row.
template <class Wide, class S, int most = 4, class Use>
void inPanels(int first, int end, Use&& use) {
  constexpr int width = Part<Wide, S>::width;
  for (int packs = (end - first + width - 1) / width; packs > 0;) {
    const int now = packs >= 2 * most ? most : packs > most ? (packs + 1) / 2 : packs;
    packs -= now;
    withConstant<most>(now, [&](auto count) { use(count, first + packs * width); });
  }
}

/// Rows that an elimination works on together.
constexpr int most_rows = 8;
/// How many packs of each of `rows` rows fit into registers. For packs of 64 bytes there are twice as many registers.
template <class Wide, int rows>
constexpr int packs_beside = std::clamp((sizeof(Wide) == 64 ? 24 : 12) / rows, 1, 4);

/// Calls use(count, first) for the rows [begin, end), `most` at a time as long as there are so many. inBlocks visits the first rows first,
/// inBlocksBackward the last ones. `count` is a constant.
template <int most = most_rows, class Use>
void inBlocks(int begin, int end, Use&& use) {
  for (int count; begin < end; begin += count) {
    count = std::min(end - begin, most);
    withConstant<most>(count, [&](auto rows) { use(rows, begin); });
  }
}
template <class Use>
void inBlocksBackward(int begin, int end, Use&& use) {
  while (begin < end) {
    const int count = std::min(end - begin, most_rows);
    end -= count;
    withConstant<most_rows>(count, [&](auto rows) { use(rows, end); });
  }
}

}  // namespace dyn::kernels
