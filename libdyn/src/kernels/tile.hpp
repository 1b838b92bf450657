// Rows of an elimination, a few packs of a few of them in registers at once.
#pragma once

#include "kernels/subtree.hpp"

#include <type_traits>

namespace dyn::kernels {

/// `rows` rows of `packs` packs, from which other rows are subtracted. All rows are `stride` apart.
template <class Wide, class S, int rows, int packs>
struct Tile {
  static constexpr int width = Part<Wide, S>::width;
  Wide sum[rows][packs];

  /// Of zeros.
  Tile() {
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = Wide(0);
  }
  Tile(const S* from, std::ptrdiff_t stride) {
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) sum[r][p] = loadPack<Wide>(from + r * stride + p * width);
  }
  /// `terms` other rows times their factors: of row r and term k at factors[r * by_row + k * by_term].
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* factors, std::ptrdiff_t by_row, std::ptrdiff_t by_term) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r * by_row + k * by_term]; });
  }
  /// The same with each row's factors, one after the other, in a place of their own.
  void subtract(const S* from, std::ptrdiff_t stride, int terms, const S* const (&factors)[rows]) {
    subtractBy(from, stride, terms, [&](int r, int k) -> const S& { return factors[r][k]; });
  }
  /// Of row `to` row `from` times a factor.
  void subtractRow(int to, int from, const S& factor) {
    for (int p = 0; p < packs; ++p) sum[to][p] -= Wide(factor) * sum[from][p];
  }
  void store(S* to, std::ptrdiff_t stride) const {
    for (int r = 0; r < rows; ++r)
      for (int p = 0; p < packs; ++p) storePack(sum[r][p], to + r * stride + p * width);
  }

 private:
  template <class Factor>
  void subtractBy(const S* from, std::ptrdiff_t stride, int terms, Factor&& factorOf) {
    for (int k = 0; k < terms; ++k, from += stride) {
      Wide other[packs];
      for (int p = 0; p < packs; ++p) other[p] = loadPack<Wide>(from + p * width);
      for (int r = 0; r < rows; ++r) {
        const Wide factor(factorOf(r, k));
        for (int p = 0; p < packs; ++p) sum[r][p] -= factor * other[p];
      }
    }
  }
};

/// Calls use(count, first) for columns from `first` on and before `end`, in panels of at most four packs that differ by no more than one; the
/// last ones first, so that what they write beyond the end may be another row's beginning. `count`: packs, a constant.
template <class Wide, class S, class Use>
void inPanels(int first, int end, Use&& use) {
  constexpr int width = Part<Wide, S>::width;
  for (int packs = (end - first + width - 1) / width; packs > 0;) {
    const int panels = (packs + 3) / 4, now = panels == 1 ? packs : (packs + panels - 1) / panels;
    packs -= now;
    const int from = first + packs * width;
    switch (now) {
      case 1:
        use(std::integral_constant<int, 1>(), from);
        break;
      case 2:
        use(std::integral_constant<int, 2>(), from);
        break;
      case 3:
        use(std::integral_constant<int, 3>(), from);
        break;
      default:
        use(std::integral_constant<int, 4>(), from);
    }
  }
}

/// Calls use(row, count) for rows from `begin` on and before `end`, two at a time as long as there are two; `count` is a constant.
template <class Use>
void byTwos(int begin, int end, Use&& use) {
  for (; begin + 2 <= end; begin += 2) use(begin, std::integral_constant<int, 2>());
  if (begin < end) use(begin, std::integral_constant<int, 1>());
}

}  // namespace dyn::kernels
