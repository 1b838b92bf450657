// Columns of a whole subtree at once: arrays of one number a degree of freedom, component after component, worked on in packs.
//
// What climbs from the joints of a subtree towards the root (forces, rows of the mass matrix and of its like) does the same at each joint
// on its way. Depth-first order puts a subtree's degrees of freedom side by side, so that one instruction takes several of them.
#pragma once

#include "kernels/columns.hpp"
#include "kernels/neighbours.hpp"
#include "kernels/workspace.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <type_traits>

namespace dyn::kernels {

/// Some neighbouring degrees of freedom, as many as Wide has lanes beside S; only those from `begin` on and before `end` belong to the
/// subtree. Where Wide is S there is one, and it does.
template <class Wide, class S>
class Part {
 public:
  using Number = Wide;
  static constexpr int width = lanes_of<Wide> / lanes_of<S>;
  Part(int first, int begin, int end) : first_(first), end_(end), inside_(chosenFrom(begin)) {}

  /// Into an array of which all lanes may be written: outside the subtree, `value` must be what was there.
  void store(const Wide& value, S* row) const { storePack(value, row + first_); }
  /// Numbers in the subtree, and zeros outside, whatever is there: others count on finding them.
  Wide inside(const Wide& x) const {
    if constexpr (width == 1) {
      return x;
    } else {
      return choose(inside_, x);
    }
  }
  Vec3<Wide> inside(const Vec3<Wide>& v) const { return {inside(v.x), inside(v.y), inside(v.z)}; }
  /// Those in the subtree from `dof` on, zeros elsewhere.
  Wide since(int dof, const Wide& x) const { return choose(chosenFrom(dof), x); }
  /// 1 for `dof` itself.
  Wide at(int dof) const { return since(dof, Wide(1)) - since(dof + 1, Wide(1)); }
  /// Whether none is before `dof`.
  bool beyond(int dof) const { return first_ >= dof; }
  int first() const { return first_; }

 private:
  /// Which lanes are chosen: all bits of theirs.
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
  /// Windows of a row of ones.
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

/// The same of one degree of freedom that is in the subtree but not of its joint: nothing is left to ask.
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

/// The sum of a pack's numbers, by halves.
template <class S, int lanes>
S sumOf(const typename Square<S, lanes>::Row& x) {
  if constexpr (lanes == 1) {
    return x[0];
  } else {
    using Numbers = Square<S, lanes>;
    return sumOf<S, lanes / 2>(Numbers::template half<0>(x) + Numbers::template half<1>(x));
  }
}
/// The same, beside S.
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

/// A matrix of n x n, in the first rows of a tile, into columns that follow one another.
template <class S, int width>
void writeSmall(const Square<S, width>& tile, int n, const Rows<S>& out) {
  for (int k = 0; k < n; ++k) {
    // Past a column's end is where the next one goes.
    S column[width];
    const bool fits = out.stride * k + width <= out.stride * n;
    tile.write(k, fits ? out[k] : column);
    if (!fits) std::copy(column, column + n, out[k]);
  }
}

/// An n x n matrix with entries for two degrees of freedom on one path to the root. It is written as the sweep finds it, joint by joint
/// with all of the joint's subtree: column k downwards into `below`, row k rightwards into `right`, from where assemble() brings them into
/// place.
template <class S>
struct PathMatrix {
  Rows<S> below, right;

  template <class Part>
  void enterBelow(const Part& part, int k, const typename Part::Number& entries) const {
    part.store(part.inside(entries), below[k]);
  }
  /// When all have been entered. Nothing turns within a joint: for two of its own, enterBelow's entries hold on both sides of the diagonal.
  void closeJoints(const CompactImpl& m) const {
    inJoints(m, [&](int row, int column) { right[row][column] = below[column][row]; });
  }
  /// After that: to entry (row, column) of two of one joint's.
  void addOwn(int row, int column, const S& x) const {
    below[column][row] += x;
    if (row < column) right[row][column] += x;
  }
  /// Writes the entries into the columns of an n x n matrix whose other entries are zero and stay so.
  template <class Wide>
  void assemble(const std::vector<int>& dof_end, const Rows<S>& out) const {
    constexpr int width = Part<Wide, S>::width;
    const int n = static_cast<int>(dof_end.size());
    if constexpr (width > 1) {
      // The last tiles overlap those before, and what they get wrong beside the diagonal the last one on it puts right.
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
  /// Calls use(row, column) for two degrees of freedom of one joint, row the first one.
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
  /// Square tiles on the diagonal, those below them that have entries, and their mirror images; none begins beyond `last_begin`.
  template <class Wide>
  void inTiles(const std::vector<int>& dof_end, int last_begin, Rows<S> out) const {
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

/// Calls use(row, column) for the squares of `width` that cover an n x n matrix, from row to row; the last ones overlap those before.
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
      // The last one on the diagonal puts right where squares overlap.
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
