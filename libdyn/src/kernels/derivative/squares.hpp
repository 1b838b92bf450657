// SPDX-License-Identifier: BSD-2-Clause
// Squares of packs, which a block of states transposes into the matrices of its states.
#pragma once

#include "kernels/derivative/path_pairs.hpp"
#include "kernels/pack/columns.hpp"

#include <algorithm>
#include <cstddef>

namespace dyn::kernels {

/// Squares that together cover the wanted numbers of an n x n matrix, column after column. Each covers as many consecutive numbers as a pack has
/// lanes, and knows where these numbers are in scratch memory. There are no squares if the matrix has fewer numbers than a pack has lanes.
template <class S>
class Squares {
 public:
  static constexpr int lanes = lanes_of<S>;

  /// wanted(row, column).
  template <class Wanted>
  void layOut(std::ptrdiff_t n, const Wanted& wanted, Arena& arena) {
    count_ = 0;
    inSquares(n, wanted, [&](std::ptrdiff_t) { ++count_; });
    arena.take(begin_, static_cast<std::size_t>(count_));
    arena.take(places_, static_cast<std::size_t>(count_ * lanes));
  }
  /// placeOf(row, column) is the place of a number in scratch memory. It must also work for numbers that are not wanted.
  template <class Wanted, class PlaceOf>
  void prepare(std::ptrdiff_t n, const Wanted& wanted, const PlaceOf& placeOf) {
    std::ptrdiff_t* begin = begin_;
    int* place = places_;
    inSquares(n, wanted, [&](std::ptrdiff_t first) {
      *begin++ = first;
      for (std::ptrdiff_t k = first; k < first + lanes; ++k) *place++ = static_cast<int>(placeOf(static_cast<int>(k % n), static_cast<int>(k / n)));
    });
  }
  bool empty() const { return count_ == 0; }

  /// Writes the numbers to the states' columns, which are `stride` apart, and leaves other numbers there as they are. Returns whether all are finite.
  template <class T>
  [[nodiscard]] bool store(const S* packs, int states, T* column, std::ptrdiff_t stride) const {
    const auto begin = [first = begin_](std::ptrdiff_t k) { return first[k]; };
    const auto from = [numbers = reinterpret_cast<const T*>(packs), places = places_](std::ptrdiff_t k) {
      return [numbers, of = places + k * lanes](int i) { return numbers + static_cast<std::ptrdiff_t>(of[i]) * lanes; };
    };
    return putSquares<T, lanes>(count_, begin, from, states, column, stride);
  }

 private:
  /// Calls use(first) for each square.
  template <class Wanted, class Use>
  static void inSquares(std::ptrdiff_t n, const Wanted& wanted, Use&& use) {
    const std::ptrdiff_t all = n * n;
    if (all < lanes) return;
    for (std::ptrdiff_t k = 0; k < all; ++k)
      if (wanted(static_cast<int>(k % n), static_cast<int>(k / n))) {
        use(std::min<std::ptrdiff_t>(k, all - lanes));
        k += lanes - 1;
      }
  }

  std::ptrdiff_t count_ = 0;
  std::ptrdiff_t* begin_ = nullptr;
  int* places_ = nullptr;
};

/// The squares of the matrices that blocks of states write.
template <class S>
struct MatrixSquares {
  using Pairs = PathPairs<S>;
  Squares<S> mass;      ///< entries on root paths of a matrix whose columns follow one another
  Squares<S> pairs[3];  ///< entries of the matrices in PathPairs: by_a, and those of q_lower and v_lower
  Squares<S> inverse;   ///< all entries of a symmetric matrix, which is stored on its diagonal and below

  // Models with couplings have no squares: their matrices are not written directly from scratch memory.
  void layOut(const CompactImpl& m, bool derivatives, Arena& arena) {
    if (!m.couplings.empty()) return;
    mass.layOut(m.nvx, onPaths(m), arena);
    if (!derivatives) return;
    if constexpr (in_pairs<S>)
      for (Squares<S>& of : pairs) of.layOut(m.nvx, onPaths(m), arena);
    inverse.layOut(m.nvx, all, arena);
  }
  void prepare(const CompactImpl& m, bool derivatives, [[maybe_unused]] const Pairs& found) {
    if (!m.couplings.empty()) return;
    const std::ptrdiff_t n = m.nvx;
    mass.prepare(n, onPaths(m), [&](int row, int column) { return n * column + row; });
    if (!derivatives) return;
    if constexpr (in_pairs<S>)
      for (const auto below : {Pairs::by_a, Pairs::q_lower, Pairs::v_lower})
        pairs[below].prepare(n, onPaths(m), [&](int row, int column) { return found.placeOf(m, below, row, column); });
    inverse.prepare(n, all, [&](int row, int column) { return n * std::min(row, column) + std::max(row, column); });
  }

 private:
  static auto onPaths(const CompactImpl& m) {
    return [&m](int row, int column) { return std::max(row, column) < m.dof_end[static_cast<std::size_t>(std::min(row, column))]; };
  }
  static bool all(int, int) { return true; }
};

}  // namespace dyn::kernels
