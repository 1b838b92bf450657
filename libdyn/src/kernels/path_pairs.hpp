// What a sweep along paths to the root finds of many states at once, a pack of states being a number: of two degrees of freedom all side by side.
#pragma once

#include "kernels/workspace.hpp"

#include <algorithm>
#include <cstddef>

namespace dyn::kernels {

template <class S>
inline constexpr bool in_pairs = lanes_of<S> > 1;

/// Numbers of each two degrees of freedom on one path to the root: entries of three matrices, in the row of the one that is farther from the root,
/// by the other's place on the path. What is stored has one address, and a few pages hold all: nothing is kept of where no path leads.
template <class S>
class PathPairs {
 public:
  enum Number { by_a, q_below, v_below, q_right, v_right, numbers };

  void carve(const CompactImpl& m, Arena& arena) {
    const auto n = static_cast<std::size_t>(m.nvx);
    arena.take(rows_, n);
    int used = 0;
    for (std::size_t k = 0; k < n; ++k) {
      if (rows_) rows_[k] = used;
      used += numbers * lengthOf(m, k);
    }
    nothing_ = used;
    arena.take(first_, static_cast<std::size_t>(used) + numbers);
  }
  /// Of degree of freedom `far` and the one on its path that has `depth` others before it, the next ones' following.
  S* row(int far, int depth) const { return first_ + rows_[far] + numbers * depth; }

  /// What there is on the other side of the diagonal.
  static constexpr Number rightOf(Number below) { return static_cast<Number>(below + (q_right - q_below)); }

  const S* begin() const { return first_; }
  /// From begin() on, where the number is that one of the matrices has in a row and a column: of a symmetric one by_a, else what it has below its
  /// diagonal; right of that it is two further on. Where no path leads, zeros.
  int placeOf(const CompactImpl& m, Number below, int row, int column) const {
    const auto at = [](int k) { return static_cast<std::size_t>(k); };
    const int near = std::min(row, column), far = std::max(row, column);
    if (far >= m.dof_end[at(near)]) return nothing_ + below;
    // Nothing turns within a joint: of two of its own both sides of the diagonal are in the row of the row.
    if (m.dof_body[at(row)] == m.dof_body[at(column)]) return rows_[row] + numbers * m.dof_depth[at(column)] + below;
    return rows_[far] + numbers * m.dof_depth[at(near)] + below + (row < column && below != by_a ? rightOf(below) - below : 0);
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
  /// With all of its joint's.
  static int lengthOf(const CompactImpl& m, std::size_t k) {
    std::size_t last = k;
    while (last + 1 < m.dof_body.size() && m.dof_body[last + 1] == m.dof_body[k]) ++last;
    return m.dof_depth[last] + 1;
  }

  S* first_ = nullptr;
  int* rows_ = nullptr;
  int nothing_ = 0;  ///< where zeros are
};

}  // namespace dyn::kernels
