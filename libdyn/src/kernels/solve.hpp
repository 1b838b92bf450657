// Solving with the factors M = L^T D L for the columns of an n x n matrix, of which each has entries for its own degree of freedom's path
// and subtree: L^T from the leaves, D, then L from the root, which fills the matrix.
#pragma once

#include "kernels/cholesky.hpp"
#include "kernels/several.hpp"

namespace dyn::kernels {

/// `begin(i)`: of row i, columns from there to the end of i's subtree have entries that L^T and D are still to be solved for; the row's
/// other entries are solved for already.
template <class S>
struct TreeSystem {
  const CompactImpl& m;
  const Rows<S>& L;
  const S* inverse;
  int n() const { return m.nvx; }
  int end(int dof) const { return m.dof_end[static_cast<std::size_t>(dof)]; }
  int parent(int dof) const { return m.dof_parent[static_cast<std::size_t>(dof)]; }
};

/// One column, `column` of the matrix, in place.
template <class S, class Begin>
void solveColumn(const TreeSystem<S>& t, const Begin& begin, int column, S* x) {
  alongPath(t.m, column, [&](int i) {
    if (begin(i) > column) return;
    const S force = x[i];
    alongPath(t.m, t.parent(i), [&](int j) { x[j] -= t.L[j][i] * force; });
    x[i] = t.inverse[i] * force;
  });
  for (int i = 0; i < t.n(); ++i) {
    S sum = x[i];
    alongPathParentLast(t.m, i, [&](int j) { sum -= t.L[j][i] * x[j]; });
    x[i] = sum;
  }
}

/// L from the root, for as many columns from `first` on as Panel has lanes.
template <class Panel, class S>
__attribute__((flatten)) void solveLower(const TreeSystem<S>& t, const Rows<S>& X, int first) {
  for (int i = 0; i < t.n(); ++i) {
    Panel x = Panel::load(X[i] + first);
    alongPathParentLast(t.m, i, [&](int j) { x -= Panel(t.L[j][i]) * Panel::load(X[j] + first); });
    x.store(X[i] + first);
  }
}

/// The whole matrix, in rows that have room for packs: few columns wide where subtrees are, as wide as registers allow where all columns are.
template <class Wide, class Pack, class S, class Begin>
__attribute__((flatten)) void solveRows(const TreeSystem<S>& t, const Begin& begin, const Rows<S>& X) {
  for (int i = t.n() - 1; i >= 0; --i)
    inParts<Wide, S>(begin(i), t.end(i), [&](const Part<Wide, S>& part) {
      const Wide entry = part.load(X[i]), force = part.inside() * entry;
      alongPath(t.m, t.parent(i), [&](int j) { part.store(part.load(X[j]) - Wide(t.L[j][i]) * force, X[j]); });
      part.store((entry - force) + Wide(t.inverse[i]) * force, X[i]);
    });
  constexpr int lanes = lanes_of<Pack>;
  const auto all = [&]<int packs>(std::integral_constant<int, packs>) {
    for (int first = 0; first < t.n(); first += packs * lanes) solveLower<Several<Pack, packs>>(t, X, first);
  };
  switch ((t.n() + lanes - 1) / lanes) {
    case 1:
      return all(std::integral_constant<int, 1>());
    case 2:
      return all(std::integral_constant<int, 2>());
    case 3:
      return all(std::integral_constant<int, 3>());
    case 5:
      // As many as four leave registers for, where there are 16 of them.
      if constexpr (lanes >= 8) return all(std::integral_constant<int, 5>());
      [[fallthrough]];
    default:
      return all(std::integral_constant<int, 4>());
  }
}

}  // namespace dyn::kernels
