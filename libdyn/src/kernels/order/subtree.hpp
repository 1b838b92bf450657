// SPDX-License-Identifier: BSD-2-Clause
// Processes the columns of a whole subtree at once, in packs. The arrays have one number per degree of freedom, component after component.
//
// Forces, rows of the mass matrix and similar quantities are propagated from the joints of a subtree to the root, with the same operations at each
// joint on the way. Depth-first order puts a subtree's degrees of freedom side by side, so one instruction processes several of them.
#pragma once

#include "kernels/body/workspace.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/pack/neighbours.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace dyn::kernels {

/// A few neighbouring degrees of freedom, `width` of them. Only those in [begin, end) belong to the subtree. If Wide is S there is one, and it
/// belongs to the subtree.
template <class Wide, class S>
class Part {
 public:
  using Number = Wide;
  static constexpr int width = lanes_of<Wide> / lanes_of<S>;
  Part(int first, int begin, int end) : first_(first), end_(end), inside_(chosenFrom(begin)) {}

  /// Writes all lanes to an array. Outside the subtree, `value` must equal what the array holds.
  void store(const Wide& value, S* row) const { storePack(value, row + first_); }
  /// x in the subtree, and zeros outside, whatever x is there. Readers rely on these zeros.
  Wide inside(const Wide& x) const {
    if constexpr (width == 1) {
      return x;
    } else {
      return choose(inside_, x);
    }
  }
  Vec3<Wide> inside(const Vec3<Wide>& v) const { return {inside(v.x), inside(v.y), inside(v.z)}; }
  /// x in the subtree from `dof` on, and zeros elsewhere.
  Wide since(int dof, const Wide& x) const { return choose(chosenFrom(dof), x); }
  /// 1 for `dof` itself, and zeros elsewhere.
  Wide at(int dof) const { return since(dof, Wide(1)) - since(dof + 1, Wide(1)); }
  /// Whether no degree of freedom here is before `dof`.
  bool beyond(int dof) const { return first_ >= dof; }
  int first() const { return first_; }

 private:
  /// A mask of lanes. All bits of a chosen lane are set.
  using Bits = Square<std::int64_t, width>;
  using Chosen = std::conditional_t<width == 1, bool, typename Bits::Row>;

  Chosen chosenFrom(int dof) const {
    if constexpr (width == 1) {
      return first_ >= dof;
    } else {
      return before(end_) & ~before(dof);
    }
  }
  static Wide choose(const Chosen& chosen, const Wide& x) {
    if constexpr (width == 1) {
      return chosen ? x : Wide(0);
    } else {
      return std::bit_cast<typename Wide::Native>(std::bit_cast<Chosen>(x.x) & chosen);
    }
  }
  /// The mask of the lanes before `dof`, a window of a row of ones and zeros.
  Chosen before(int dof) const {
    alignas(64) static constexpr auto ones = [] {
      std::array<std::int64_t, 2 * width> x{};
      for (int l = 0; l < width; ++l) x[static_cast<std::size_t>(l)] = -1;
      return x;
    }();
    return *reinterpret_cast<const typename Bits::Unaligned*>(ones.data() + width - std::clamp(dof - first_, 0, width));
  }

  int first_, end_;
  Chosen inside_;
};

/// The same for one degree of freedom that is in the subtree but does not belong to its root joint, so nothing needs to be masked.
template <class S>
class Descendant {
 public:
  using Number = S;
  explicit Descendant(int first) : first_(first) {}
  void store(const S& value, S* row) const { storePack(value, row + first_); }
  const S& inside(const S& x) const { return x; }
  const Vec3<S>& inside(const Vec3<S>& v) const { return v; }
  const S& since(int, const S& x) const { return x; }
  S at(int) const { return S(0); }
  bool beyond(int) const { return true; }
  int first() const { return first_; }

 private:
  int first_;
};

/// The sum of a pack's numbers, formed by halves.
template <class S, int lanes>
S sumOf(const typename Square<S, lanes>::Row& x) {
  if constexpr (lanes == 1) {
    return x[0];
  } else {
    using Numbers = Square<S, lanes>;
    return sumOf<S, lanes / 2>(Numbers::template half<0>(x) + Numbers::template half<1>(x));
  }
}
/// The sum of the numbers S in a pack Wide. If Wide has the lanes of S, this is x itself.
template <class S, class Wide>
S total(const Wide& x) {
  if constexpr (lanes_of<Wide> == lanes_of<S>) {
    return x;
  } else {
    using Numbers = Square<S, lanes_of<Wide>>;
    const typename Numbers::Row numbers = *reinterpret_cast<const typename Numbers::Unaligned*>(&x);
    return sumOf<S, lanes_of<Wide>>(numbers);
  }
}

/// Writes an n x n matrix, held in the first rows of a tile, into consecutive columns.
template <class S, int width>
void writeSmall(const Square<S, width>& tile, int n, const Rows<S>& out) {
  for (int k = 0; k < n; ++k) {
    // A write past the end of a column hits the next column, which is written later.
    S column[width];
    const bool fits = out.stride * k + width <= out.stride * n;
    tile.write(k, fits ? out[k] : column);
    if (!fits) std::copy(column, column + n, out[k]);
  }
}

/// An n x n matrix with entries for pairs of degrees of freedom on one root path. The sweep writes it joint by joint, each joint with all of its
/// subtree: column k downwards into `below`, and row k rightwards into `right`. assemble() moves the entries into place.
template <class S>
struct PathMatrix {
  Rows<S> below, right;

  template <class Part>
  void enterLower(const Part& part, int k, const typename Part::Number& entries) const {
    part.store(part.inside(entries), below[k]);
  }
  /// Must be called after all entries are written. Within a joint no degree of freedom turns another, so enterLower()'s entries for two of them hold
  /// on both sides of the diagonal.
  void closeJoints(const CompactImpl& m) const {
    inJoints(m, [&](int row, int column) { right[row][column] = below[column][row]; });
  }
  /// After closeJoints(): adds x to entry (row, column) of two degrees of freedom of one joint.
  void addOwn(int row, int column, const S& x) const {
    below[column][row] += x;
    if (row < column) right[row][column] += x;
  }
  /// Writes the entries into the columns of an n x n matrix whose other entries are zero and stay so.
  template <class Wide>
  void assemble(const SharedVector<int>& dof_end, const Rows<S>& out) const {
    constexpr int width = Part<Wide, S>::width;
    const int n = static_cast<int>(dof_end.size());
    if constexpr (width > 1) {
      // The last tiles overlap those before. Wrong entries that they write beside the diagonal are corrected by the last tile on it.
      if (n >= width) return inTiles<Wide>(dof_end, n - width, out);
      writeSmall(diagonalTile<width>(0), n, out);
    } else {
      for (int k = 0; k < n; ++k)
        for (int i = k; i < dof_end[static_cast<std::size_t>(k)]; ++i) {
          out[i][k] = right[k][i];
          out[k][i] = below[k][i];
        }
    }
  }

 private:
  /// Calls use(row, column) for each two degrees of freedom of one joint, with row < column.
  template <class Use>
  static void inJoints(const CompactImpl& m, Use&& use) {
    for (const Run& run : m.runs) {
      if (run.nv == 1) continue;
      const int begin = m.index[static_cast<std::size_t>(run.first)].idx_v;
      for (int joint = begin; joint < begin + run.count * run.nv; joint += run.nv)
        for (int row = joint; row < joint + run.nv; ++row)
          for (int column = row + 1; column < joint + run.nv; ++column) use(row, column);
    }
  }
  /// Writes the square tiles on the diagonal, those below them that have entries, and their mirror images. None begins beyond `last_begin`.
  template <class Wide>
  void inTiles(const SharedVector<int>& dof_end, int last_begin, Rows<S> out) const {
    const Rows<S> across = right;
    constexpr int width = Part<Wide, S>::width;
    const int n = static_cast<int>(dof_end.size());
    Square<S, width> lower, upper;
    for (int column = 0; column < n; column += width) {
      const int left = std::min(column, last_begin);
      const int last = column + width < n ? *std::max_element(dof_end.begin() + left, dof_end.begin() + std::min(left + width, n)) : 0;
      for (int row = column + width; row < last; row += width) {
        const int top = std::min(row, last_begin);
        lower.read(below[left] + top, below.stride);
        lower.write(out[left] + top, out.stride);
        upper.read(across[left] + top, across.stride);
        upper.transpose();
        upper.write(out[top] + left, out.stride);
      }
      diagonalTile<width>(left).write(out[left] + left, out.stride);
    }
  }
  template <int width>
  Square<S, width> diagonalTile(int first) const {
    Square<S, width> lower, upper;
    lower.read(below[first] + first, below.stride);
    upper.read(right[first] + first, right.stride);
    upper.transpose();
    lower.replaceAbove(upper);
    return lower;
  }
};

/// Calls use(row, column) for the squares of `width` that cover an n x n matrix, row by row. The last squares overlap those before.
template <int width, class Use>
void inSquares(int n, Use&& use) {
  for (int row = 0; row < n; row += width)
    for (int column = 0; column < n; column += width) use(std::min(row, n - width), std::min(column, n - width));
}

/// Completes a symmetric n x n matrix, whose rows have room for whole tiles, from its upper triangle.
template <class Wide, class S>
void mirrorUpper(Rows<S> M, int n) {
  constexpr int width = Part<Wide, S>::width;
  if constexpr (width > 1) {
    const auto onDiagonal = [&](int first) {
      Square<S, width> tile, below;
      tile.read(M[first] + first, M.stride);
      below = tile;
      below.transpose();
      tile.replaceAbove(below);
      return tile;
    };
    if (n < width) return writeSmall(onDiagonal(0), n, M);
    inSquares<width>(n, [&](int row, int column) {
      if (column < row) return;
      // Where squares overlap, the last one on the diagonal corrects the entries.
      if (column == row) return onDiagonal(row).write(M[row] + row, M.stride);
      Square<S, width> square;
      square.read(M[row] + column, M.stride);
      square.transpose();
      square.write(M[column] + row, M.stride);
    });
  } else {
    for (int i = 0; i < n; ++i)
      for (int j = i + 1; j < n; ++j) M[j][i] = M[i][j];
  }
}

}  // namespace dyn::kernels
