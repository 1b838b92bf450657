// The factors of M from articulated inertias, and its inverse.
//
// Eliminating the degrees of freedom of a subtree leaves, of row i of M, the articulated force column IA s_i moved rigidly to each joint on
// its path, times the motion there. Pivots and rows that are read off articulated inertias have not gone through M, whose cancellation
// costs as many digits as its condition number has.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/crba.hpp"
#include "kernels/path_sweep.hpp"
#include "kernels/solve.hpp"
#include "kernels/strip_paths.hpp"

namespace dyn::kernels {

/// Eliminates the degrees of freedom of body i, the last first: use(k, column, W, inverse, row) is called for each, W = IA s, inverse that of the
/// pivot, row their product.
template <class Joint, class S, class Order, class Use>
void eliminateJoint(const Order& order, Workspace<S>& w, ArticulatedInertia<S>& IA, int i, int iv, Use&& use) {
  if constexpr (Joint::is_free) {
    if (isBareRoot<Joint>(order, i)) {
      const AxesElimination<true, S> axes(order, IA, i, iv, w.failed);
      for (int p = 0; p < 6; ++p) {
        const Force<S> W = axes.column(p);
        use(axes.axis(p), UnitColumn<S>{axes.axis(p)}, W, axes.inverse(p), axes.inverse(p) * W);
      }
      return;
    }
  }
  withColumns<Joint>(order, w, i, iv, [&](const auto& columns) {
    for (int k = Joint::nv - 1; k >= 0; --k) {
      const auto column = columns(k);
      const Force<S> W = column.force(IA);
      const S pivot = column.along(W) + order.armature(iv + k), inverse = S(1) / pivot;
      noteVanishing(pivot, column, IA, i, w.failed);
      const Force<S> row = inverse * W;
      use(k, column, W, inverse, row);
      if (k > 0 || !order.isRoot(i)) IA.subtractSquare(W, inverse);
    }
  });
}

/// Pivots and force columns, after columnsOutward: enter(dof, inverse, row). w.failed tells lane by lane whether one vanished.
template <class S, class Order, class Enter>
void articulatedFactors(const Order& order, Workspace<S>& w, Enter&& enter) {
  for (int& body : w.failed) body = 0;
  order.backward(passing(w.IA), [&]<class Joint>(const Joint&, int i, int iv, auto&& inertia) {
    const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(mass, h, I));
    eliminateJoint<Joint>(order, w, IA, i, iv,
                          [&](int k, const auto&, const Force<S>&, const S& inverse, const Force<S>& row) { enter(iv + k, inverse, row); });
    if (!order.isRoot(i)) inertia.give(IA.shifted(w.r[i]));
  });
}

/// The factors of M, with joints in w. Quad: in whose lanes strips may be.
template <class Wide, class Quad = Wide, class S>
void treeFactors(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  // Entries are written one by one, which as in the mass matrix wants lanes that are nearly full.
  withRecursion<Quad>(m, w, d, m.strips.used_for_mass_matrix, [&](const auto& r) {
    using T = typename std::remove_cvref_t<decltype(r)>::Scalar;
    columnsOutward(r.order, r.order.w);
    T* inverses = r.out(d.factors.inverse);
    articulatedFactors(r.order, r.order.w, [&](int dof, const T& inverse, const Force<T>& row) {
      inverses[dof] = inverse;
      r.d.dof_force[dof].by_a = row;
    });
    if constexpr (std::remove_cvref_t<decltype(r)>::over_strips) {
      r.put(inverses, d.factors.inverse);
      stripFactorsSweep(r, d.factors.L);
    } else {
      factorsSweep<Wide>(r, d);
    }
    r.failures(w.failed);
  });
}

/// M^-1 from its factors, n x n, by way of the n rows X. Half of it is solved for: the result is symmetric to the last bit.
template <class Wide, class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, const Rows<S>& X, const Rows<S>& out) {
  const int n = m.nvx;
  const TreeSystem<S> system{m, factors.L, factors.inverse};
  std::fill(X[0], X[n], S(0));
  for (int i = 0; i < n; ++i) X[i][i] = S(1);
  solveUpper<Wide>(system, X, 0, wholeBlocks);
  solveLower<Wide>(system, X, X, n, true);
  mirrorUpper<Wide>(X, n, out);
}
/// The same in lanes, in place.
template <class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, S* out) {
  const int n = m.nvx;
  const TreeSystem<S> system{m, factors.L, factors.inverse};
  const ByColumns<S> X{out, n};
  for (int k = 0; k < n; ++k) {
    std::fill(place(X, 0, k), place(X, k, k), S(0));
    *place(X, k, k) = S(1);
  }
  solveUpper<S>(system, X, 0, [](int column) { return column + 1; });
  solveLower<S>(system, X, X, n, true);
  for (int i = 0; i < n; ++i)
    for (int k = i + 1; k < n; ++k) *place(X, k, i) = *place(X, i, k);
}
/// The same column by column, into zeros.
template <class S, class Order>
void inverseOfMassMatrixColumns(const Order& order, const TreeFactors<S>& factors, const Rows<S>& out) {
  const TreeSystem<S> system{order.m, factors.L, factors.inverse};
  order.eachDof(0, order.m.nvx, [&](int k) {
    out[k][k] = S(1);
    solveColumn(
        system, order, [](int i) { return i; }, k, k + 1, out[k]);
    for (int i = 0; i < k; ++i) out[i][k] = out[k][i];
  });
}

}  // namespace dyn::kernels
