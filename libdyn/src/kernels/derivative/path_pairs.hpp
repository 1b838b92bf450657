// SPDX-License-Identifier: BSD-2-Clause
// The results of a sweep along root paths for many states at once, where a number is a pack of states. All numbers of two degrees of freedom are side
// by side.
#pragma once

#include "kernels/derivative/dof_forces.hpp"
#include "kernels/derivative/tree_factors.hpp"

#include <algorithm>
#include <cstddef>

namespace dyn::kernels {

template <class S>
inline constexpr bool in_pairs = lanes_of<S> > 1;

/// The entries of three matrices for each two degrees of freedom on one root path. They are in the row of the one that is farther from the root, by
/// the other's place on the path. Entries off the paths are not stored, so a few pages hold all. The entries of a floating base with the forces of
/// other joints are not stored either: its columns are unit vectors, so these entries are the coordinates of the forces at the root (DofForces).
template <class S>
class PathPairs {
 public:
  enum Number { by_a, q_lower, v_lower, q_upper, v_upper, numbers };  ///< only rnea uses the upper ones; aba has ColumnProjections

  /// `forces`: one for each degree of freedom.
  void layOut(const CompactImpl& m, const DofForces<S>* forces, Arena& arena) {
    const auto n = static_cast<std::size_t>(m.nvx);
    arena.take(rows_, n);
    int used = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (rows_) rows_[k] = used;
      used += numbers * pathLength(m, static_cast<int>(k));
    }
    nothing_ = used;
    arena.take(first_, static_cast<std::size_t>(used) + 1);
    if (first_) forces_ = static_cast<int>(reinterpret_cast<const S*>(forces) - first_);
  }
  /// The entries of degree of freedom `far` with the one at `depth` on its path, followed by those with the next ones on the path.
  S* row(int far, int depth) const { return first_ + rows_[far] + numbers * depth; }
  /// The forces of degree of freedom `far` at the root, which hold its entries with a floating base.
  const DofForces<S>& forces(int far) const { return reinterpret_cast<const DofForces<S>*>(first_ + forces_)[far]; }

  const S* begin() const { return first_; }
  /// The place, counted from begin(), of the entry in this row and column of a matrix, after a sweep over rigid subtrees (pathSweep). The place of a
  /// zero if the two degrees of freedom are not on one path.
  int placeOf(const CompactImpl& m, Number below, int row, int column) const {
    const auto at = [](int k) { return static_cast<std::size_t>(k); };
    const int near = std::min(row, column), far = std::max(row, column);
    if (far >= m.dof_end[at(near)]) return nothing_;
    // Nothing turns within a joint: for two of its degrees of freedom, the row of `row` has the entries on both sides of the diagonal.
    const int body = m.dof_body[at(near)];
    if (body == m.dof_body[at(far)]) return rows_[row] + numbers * m.dof_depth[at(column)] + below;
    const Number number = row < column && below != by_a ? rightOf(below) : below;
    const BodyIndex& x = m.index[at(body)];
    if (x.floating_base && number != v_lower) {
      const int axis = near - x.idx_v;
      if (number != q_lower) return placeOfForce(number, far, axis);
      if (axis < 3) return nothing_;  // translating the base changes no force
    }
    return rows_[far] + numbers * m.dof_depth[at(near)] + number;
  }
  S& at(const CompactImpl& m, Number below, int row, int column) const { return first_[placeOf(m, below, row, column)]; }

  /// One of the matrices, column after column.
  void expand(const CompactImpl& m, Number below, S* matrix) const {
    const std::ptrdiff_t n = m.nvx;
    std::fill_n(matrix, n * n, S(0));
    for (int near = 0; near < m.nvx; ++near)
      for (int far = near, end = m.dof_end[static_cast<std::size_t>(near)]; far < end; ++far) {
        matrix[n * near + far] = at(m, below, far, near);
        matrix[n * far + near] = at(m, below, near, far);
      }
  }

 private:
  /// The number for the other side of the diagonal.
  static constexpr Number rightOf(Number below) { return static_cast<Number>(below + (q_upper - q_lower)); }
  /// The place of coordinate `axis` of the force of `far` that belongs to `number`.
  int placeOfForce(Number number, int far, int axis) const {
    const DofForces<S>& of = forces(far);
    const Force<S>& force = number == by_a ? of.by_a : number == q_upper ? of.by_q : of.by_v;
    return static_cast<int>(&(axis < 3 ? force.linear : force.angular)[axis % 3] - first_);
  }

  S* first_ = nullptr;
  int* rows_ = nullptr;
  int nothing_ = 0, forces_ = 0;  ///< places of a zero and of the forces
};

}  // namespace dyn::kernels
