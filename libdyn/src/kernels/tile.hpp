// Rows of an elimination, a few packs of a few of them in registers at once.
#pragma once

#include "kernels/subtree.hpp"

#include <type_traits>

namespace dyn::kernels {

/// `rows` rows of `packs` packs, to which other rows are added. All rows are `stride` apart.
template <class Wide, class S, int rows_, int packs_>
struct Tile {
  static constexpr int rows = rows_, packs = packs_;
  static constexpr int width = Part<Wide, S>::width;
  Wide sum[rows][packs];

  /// Of zeros.
  Tile() {
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = Wide(0);
  }
  Tile(const S* from, std::ptrdiff_t stride) {
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r, from += stride)
      for (int p = 0; p < packs; ++p) sum[r][p] = loadPack<Wide>(from + p * width);
  }
  /// `terms` other rows times their factors: of row r and term k at factors[r * by_row + k * by_term].
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* factors, std::ptrdiff_t by_row, std::ptrdiff_t by_term) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r * by_row + k * by_term]; });
  }
  /// The same with each row's factors, one after the other, in a place of their own.
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* const (&factors)[rows]) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r][k]; });
  }
  void negate() {
#pragma GCC unroll 8
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = -sum[r][p];
  }
  /// To the rows from the `begin`-th on another one times `scale` and each one's factor.
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

/// Calls use(count, first) for columns from `first` on and before `end`, in panels of at most `most` packs, the last two alike but for one; the
/// last ones first, so that what they write beyond the end may be another row's beginning. `count`: packs, a constant.
template <class Wide, class S, int most = 4, class Use>
void inPanels(int first, int end, Use&& use) {
  constexpr int width = Part<Wide, S>::width;
  for (int packs = (end - first + width - 1) / width; packs > 0;) {
    const int now = packs >= 2 * most ? most : packs > most ? (packs + 1) / 2 : packs;
    packs -= now;
    withConstant<most>(now, [&](auto count) { use(count, first + packs * width); });
  }
}

/// Rows that are worked on together.
constexpr int most_rows = 8;
/// The packs of so many rows that have their places in registers, of which packs of 64 bytes have twice as many.
template <class Wide, int rows>
constexpr int packs_beside = std::clamp((sizeof(Wide) == 64 ? 24 : 12) / rows, 1, 4);

/// Calls use(count, first) for rows from `begin` on and before `end`, `most` at a time as long as there are so many, the first or the last ones
/// first; `count` is a constant.
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
