// The factors of M that follow the tree: M = L^T D L, L unit lower triangular with entries only for degrees of freedom on one path to the
// root (Featherstone 2005, "Efficient factorization of the joint-space inertia matrix for branched kinematic trees").
#pragma once

#include "kernels/pivots.hpp"
#include "kernels/subtree.hpp"

#include <limits>

namespace dyn::kernels {

/// Calls use(j) for each degree of freedom on the path from `dof` to the root, itself included.
template <class Use>
void alongPath(const CompactImpl& m, int dof, Use&& use) {
  while (dof >= 0) {
    const int begin = m.dof_segment[static_cast<std::size_t>(dof)];
    for (int j = dof; j >= begin; --j) use(j);
    dof = m.dof_parent[static_cast<std::size_t>(begin)];
  }
}

/// The same but `dof` itself; its parent, which is often the last to be known, comes last.
template <class Use>
void alongPathParentLast(const CompactImpl& m, int dof, Use&& use) {
  const int parent = m.dof_parent[static_cast<std::size_t>(dof)];
  if (parent < 0) return;
  alongPath(m, m.dof_parent[static_cast<std::size_t>(parent)], use);
  use(parent);
}

/// Calls use(first) for the packs, of a row of numbers by degree of freedom, in which the path from `dof` to the root has entries.
template <int width, class Use>
void alongPathInPacks(const CompactImpl& m, int dof, Use&& use) {
  int last = std::numeric_limits<int>::max();  // of the packs that have been used
  while (dof >= 0) {
    const int begin = m.dof_segment[static_cast<std::size_t>(dof)];
    int first = dof / width * width;
    if (first == last) first -= width;
    for (; first + width > begin; first -= width) use(first);
    last = first + width;
    dof = m.dof_parent[static_cast<std::size_t>(begin)];
  }
}

template <class S>
struct TreeFactors {
  Rows<S> L;              ///< row j: column j of L, below the diagonal; kept as PathMatrix::below is
  S* diagonal = nullptr;  ///< D
  S* inverse = nullptr;   ///< 1 / D
};

template <class S>
void carve(TreeFactors<S>& c, int n, Arena& arena) {
  arena.take(c.L, n, n);
  arena.take(c.diagonal, static_cast<std::size_t>(n));
  arena.take(c.inverse, static_cast<std::size_t>(n));
}

/// Of M, n x n, column-major, symmetric. `scratch`: n rows. Notes in `failed`, lane by lane, the first degree of freedom, plus one, whose
/// pivot is not above the rounding of what it was subtracted from.
template <class Wide, class S>
void choleskyDecompose(const CompactImpl& m, const S* M, const Rows<S>& scratch, TreeFactors<S>& c, int* failed) {
  constexpr int width = Part<Wide, S>::width;
  const int n = m.nvx;
  const auto parent = [&](int dof) { return m.dof_parent[static_cast<std::size_t>(dof)]; };
  const auto pack = [](S* row, int first) { return Part<Wide, S>(first, first, first + width).load(row); };
  const auto keep = [](const Wide& x, S* row, int first) { Part<Wide, S>(first, first, first + width).store(x, row); };
  std::fill(failed, failed + lanes_of<S>, 0);
  for (int i = 0; i < n; ++i) alongPath(m, i, [&](int j) { scratch[i][j] = M[static_cast<std::ptrdiff_t>(n) * i + j]; });
  for (int i = n - 1; i >= 0; --i) {
    S* row = scratch[i];
    const S pivot = row[i];
    noteSmall(pivot, S(8 * std::numeric_limits<Real<S>>::epsilon()) * M[static_cast<std::ptrdiff_t>(n + 1) * i], i + 1, failed);
    const S inverse = S(1) / pivot;
    c.diagonal[i] = pivot;
    c.inverse[i] = inverse;
    alongPath(m, parent(i), [&](int j) {
      // Packs reach beyond the diagonal, into numbers that nobody reads.
      const S entry = inverse * row[j];
      c.L[j][i] = entry;
      S* other = scratch[j];
      alongPathInPacks<width>(m, j, [&](int first) { keep(pack(other, first) - Wide(entry) * pack(row, first), other, first); });
    });
  }
}

enum class FactorProduct { inverse, mass_matrix, upper, lower };

/// x = M^-1 x, M x, L^T x or L x, in place of nvx numbers with room for a pack. Each column of L is a subtree's, side by side.
template <class Wide, class S>
void factorTimes(const CompactImpl& m, const TreeFactors<S>& c, FactorProduct product, S* x) {
  using P = Part<Wide, S>;
  const int n = m.nvx;
  const auto below = [&](int j, auto use) { inParts<Wide, S>(j + 1, m.dof_end[static_cast<std::size_t>(j)], use); };
  // Column j of L with the numbers below j.
  const auto gathered = [&](int j) {
    Wide sum(0);
    below(j, [&](const P& part) { sum += part.inside() * part.load(c.L[j]) * part.load(x); });
    return total<S>(sum);
  };
  const auto spread = [&](int j, const S& factor) {
    below(j, [&](const P& part) { part.store(part.load(x) + part.inside() * (Wide(factor) * part.load(c.L[j])), x); });
  };
  const bool inverse = product == FactorProduct::inverse, whole = product == FactorProduct::mass_matrix;
  if (inverse)
    for (int j = n - 1; j >= 0; --j) x[j] -= gathered(j);
  if (whole || product == FactorProduct::lower)
    for (int j = n - 1; j >= 0; --j) spread(j, x[j]);
  if (inverse || whole)
    for (int j = 0; j < n; ++j) x[j] *= inverse ? c.inverse[j] : c.diagonal[j];
  if (whole || product == FactorProduct::upper)
    for (int j = 0; j < n; ++j) x[j] += gathered(j);
  if (inverse)
    for (int j = 0; j < n; ++j) spread(j, -x[j]);
}

}  // namespace dyn::kernels
