// What a sweep along paths to the root finds of many states at once, a pack of states being a number: of two degrees of freedom all side by side.
#pragma once

#include "kernels/dof_forces.hpp"
#include "kernels/tree_factors.hpp"

#include <algorithm>
#include <cstddef>

namespace dyn::kernels {

template <class S>
inline constexpr bool in_pairs = lanes_of<S> > 1;

/// Numbers of each two degrees of freedom on one path to the root: entries of three matrices, in the row of the one that is farther from the root,
/// by the other's place on the path. What is stored has one address, and a few pages hold all: nothing is kept of where no path leads. Nor of what a
/// flying root's columns, unit vectors, find of others' forces: these have it themselves when they have climbed.
template <class S>
class PathPairs {
 public:
  enum Number { by_a, q_below, v_below, q_right, v_right, numbers };  ///< those on the right of rnea; aba has ColumnShares

  /// `forces`: the degrees of freedom's.
  void carve(const CompactImpl& m, const DofForces<S>* forces, Arena& arena) {
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
  /// Of degree of freedom `far` and the one on its path that has `depth` others before it, the next ones' following.
  S* row(int far, int depth) const { return first_ + rows_[far] + numbers * depth; }
  /// Where those are that a flying root's columns have found something of.
  const DofForces<S>& forces(int far) const { return reinterpret_cast<const DofForces<S>*>(first_ + forces_)[far]; }

  const S* begin() const { return first_; }
  /// From begin() on, where a sweep over rigid subtrees leaves what one of the matrices has in a row and a column; zeros where no path leads.
  int placeOf(const CompactImpl& m, Number below, int row, int column) const {
    const auto at = [](int k) { return static_cast<std::size_t>(k); };
    const int near = std::min(row, column), far = std::max(row, column);
    if (far >= m.dof_end[at(near)]) return nothing_;
    // Nothing turns within a joint: of two of its own both sides of the diagonal are in the row of the row.
    const int body = m.dof_body[at(near)];
    if (body == m.dof_body[at(far)]) return rows_[row] + numbers * m.dof_depth[at(column)] + below;
    const Number number = row < column && below != by_a ? rightOf(below) : below;
    const BodyIndex& x = m.index[at(body)];
    if (x.flying_root && number != v_below) {
      const int axis = near - x.idx_v;
      if (number != q_below) return placeOfForce(number, far, axis);
      if (axis < 3) return nothing_;  // wherever it is, it is as it was
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
  /// What there is on the other side of the diagonal.
  static constexpr Number rightOf(Number below) { return static_cast<Number>(below + (q_right - q_below)); }
  /// Of the force that has that number along its own axes, number `axis` of it.
  int placeOfForce(Number number, int far, int axis) const {
    const DofForces<S>& of = forces(far);
    const Force<S>& force = number == by_a ? of.by_a : number == q_right ? of.by_q : of.by_v;
    return static_cast<int>(&(axis < 3 ? force.linear : force.angular)[axis % 3] - first_);
  }

  S* first_ = nullptr;
  int* rows_ = nullptr;
  int nothing_ = 0, forces_ = 0;  ///< where a zero is, and the forces
};

}  // namespace dyn::kernels
