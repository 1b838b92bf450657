// The factors of M^-1 from articulated inertias, and their product.
//
// A unit force along a degree of freedom leaves its joint as the articulated force column IA s / pivot. On its way to the root each joint gives way
// to it, as in aba, and the shares that the joints get are a column of U. Pivots and shares that are read off articulated inertias have not
// gone through M, whose cancellation costs as many digits as its condition number has.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/crba.hpp"
#include "kernels/path_sweep.hpp"
#include "kernels/state_products.hpp"
#include "kernels/strip_factors.hpp"
#include "kernels/tree_products.hpp"

namespace dyn::kernels {

/// Whether it is wanted what is left of body i when its joint gives way: the parent is handed it, or the force through a joint of varying subspace
/// is made of it.
template <class Joint, class Order>
bool needsRest(const Order& order, int i) {
  return Joint::has_bias || !order.isRoot(i);
}

/// Eliminates the degrees of freedom of body i, the last first: use(k, column, inverse, row) is called for each, inverse that of the pivot,
/// row = inverse IA s.
template <class Joint, class S, class Order, class Use>
void eliminateJoint(const Order& order, Workspace<S>& w, ArticulatedInertia<S>& IA, int i, int iv, Use&& use) {
  if constexpr (Joint::is_free) {
    if (isBareRoot<Joint>(order, i)) {
      const AxesElimination<true, S> axes(order, IA, i, iv, w.failed);
#pragma GCC unroll 6
      for (int p = 0; p < 6; ++p) use(axes.axis(p), UnitColumn<S>{axes.axis(p)}, axes.inverse(p), axes.inverse(p) * axes.column(p));
      return;
    }
  }
  withColumns<Joint>(order, w, i, iv, [&](const auto& columns) {
    for (int k = nvOf<Joint>(order, i) - 1; k >= 0; --k) {
      const auto column = columns(k);
      const Force<S> W = column.force(IA);
      const S pivot = column.along(W) + order.armature(iv + k), inverse = S(1) / pivot;
      noteVanishing(pivot, column, IA, i, w.failed);
      const Force<S> row = inverse * W;
      use(k, column, inverse, row);
      if (k > 0 || needsRest<Joint>(order, i)) IA.subtractSquare(W, inverse);
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
    eliminateJoint<Joint>(order, w, IA, i, iv, [&](int k, const auto&, const S& inverse, const Force<S>& row) { enter(iv + k, inverse, row); });
    if (order.isRoot(i)) return;
    if (order.hasLever(i)) IA = IA.shifted(w.r[i]);
    inertia.give(IA);
  });
}

/// The factors of M^-1, with joints in w. Quad: in whose lanes strips may be.
template <class Wide, class Quad = Wide, class S>
void treeFactors(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  withRecursion<Quad>(m, w, d, m.strips.uses.derivatives, [&](const auto& r) {
    using Recursion = std::remove_cvref_t<decltype(r)>;
    using T = typename Recursion::Scalar;
    columnsOutward(r.order, r.order.w);
    T* inverses = r.out(d.factors.inverse);
    articulatedFactors(r.order, r.order.w, [&](int dof, const T& inverse, const Force<T>& row) {
      inverses[dof] = inverse;
      r.d.dof_force[dof].by_a = row;
    });
    if constexpr (Recursion::over_strips) {
      r.put(inverses, d.factors.inverse);
      stripFactorsSweep(r, d.factors.U);
    } else {
      factorsSweep<Wide>(r, d);
    }
    r.failures(w.failed);
  });
}

/// M^-1 from its factors, n x n with room for a pack behind it; symmetric to the last bit.
template <class Wide, class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, const Rows<S>& out) {
  downTheTree<Wide, true>(m, factors, factors.U, FromZeros(), out);
  mirrorUpper<Wide>(out, m.nvx);
}
/// Of states in packs, on the diagonal and below.
template <class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, const ProductScratch<S>& scratch, const Rows<S>& out) {
  inChains(m, factors, scratch, [&]<int columns>(const ChainProduct<S>& chain, int j) {
    chain.template write<columns, 1>(j, chain.pathOf(j + columns - 1), chain.template sharesOfU<columns>(j), out[j], out.stride);
  });
}

}  // namespace dyn::kernels
