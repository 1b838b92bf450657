// SPDX-License-Identifier: BSD-2-Clause
// Elimination of the six degrees of freedom of a floating base. Their columns are the unit vectors of its own axes.
#pragma once

#include "kernels/pack/pivots.hpp"

#include <dyn/spatial/inertia.hpp>

#include <algorithm>

namespace dyn::kernels {

/// Calls use(k) for the six directions, linear ones first.
template <class Use>
void eachAxis(Use&& use) {
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) use(k);
}

/// Factors a floating base's articulated inertia, the matrix from which its six directions are eliminated. `last_first`: the last direction goes
/// first, otherwise the first one. Products of entries are formed first, because the pivot that divides them is known last.
template <bool last_first, class S>
class AxesElimination {
 public:
  /// i is the body, iv its first degree of freedom. Notes i in `failed` where a pivot vanishes.
  template <class Order>
  AxesElimination(const Order& order, const ArticulatedInertia<S>& IA, int i, int iv, int* failed) {
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
      for (int c = 0; c <= r; ++c) left_[r][c] = entry(IA, std::max(axis(r), axis(c)), std::min(axis(r), axis(c)));
#pragma GCC unroll 6
    for (int p = 0; p < 6; ++p) {
      // The pivot is compared with the inertia left in this direction and in the later ones of the same three.
      S three = left_[p][p];
      for (int r = p + 1; r < (p < 3 ? 3 : 6); ++r) three += left_[r][r];
      // Lanes without a body have armature, so that their pivots do not vanish.
      const S pivot = left_[p][p] + order.armature(iv + axis(p));
      noteVanishing(pivot, three, i, failed);
      inverse_[p] = S(1) / pivot;
#pragma GCC unroll 6
      for (int r = p + 1; r < 6; ++r)
#pragma GCC unroll 6
        for (int c = p + 1; c <= r; ++c) left_[r][c] -= left_[r][p] * left_[c][p] * inverse_[p];
    }
  }

  /// The axis that is eliminated p-th. The same function gives the step that eliminates axis p.
  static constexpr int axis(int p) { return last_first ? 5 - p : p; }
  const S& inverse(int p) const { return inverse_[p]; }
  /// The column of step p just before its elimination. Entries of axes that were eliminated earlier are zero.
  Force<S> column(int p) const {
    const auto along = [&](int d) { return axis(d) < p ? S(0) : left_[axis(d)][p]; };
    return {{along(0), along(1), along(2)}, {along(3), along(4), along(5)}};
  }
  /// Replaces y by D^-1 L^-1 y. y are forces along the axes in the order of elimination.
  void solve(S (&y)[6]) const {
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      y[k] = y[k] * inverse_[k];
#pragma GCC unroll 6
      for (int r = k + 1; r < 6; ++r) y[r] -= y[k] * left_[r][k];
    }
  }

 private:
  static S entry(const ArticulatedInertia<S>& I, int r, int c) {
    if (r < 3) return I.linear.matrix().col(c)[r];
    return c < 3 ? I.coupling.row(c)[r - 3] : I.angular.matrix().col(c - 3)[r - 3];
  }
  S left_[6][6], inverse_[6];
};

}  // namespace dyn::kernels
