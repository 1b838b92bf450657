// SPDX-License-Identifier: BSD-2-Clause
// The factors of M^-1 from articulated inertias, and their product: M^-1 = U^T D^-1 U. O(n depth) for the factors, O(n^2 depth) at most for M^-1.
//
// A unit force along a degree of freedom leaves its joint as the articulated force column row = IA S / D (Featherstone 2008, ch. 7). On the root path
// each joint is projected out, as in aba, and the projections are a column of U. These pivots and projections are not computed from M, whose
// cancellation costs as many digits as its condition number has. All vectors are in aligned axes, at the joint's origin, letters as in aba.hpp:
//
//   (1)  IA = rigid(m, h, I) + sum over children of IA', each moved by its r
//   (2)  W = IA S,   D = S^T W + armature,   row = W / D,   IA -= W W^T / D             last degree of freedom of a joint first
//   (3)  for each degree of freedom j:  U(j, j) = -1 and F = row_j;   for k before j in its joint and k of the joints on the root path,
//        the last one of a joint first:  U(k, j) = S_k^T F,   F -= U(k, j) row_k;   from joint to joint  F.angular += r x F.linear
//   (4)  (M^-1)_ij = sum of U(k, i) U(k, j) / D_k over the k whose subtrees have both i and j
#pragma once

#include "kernels/derivative/lane_group_factors.hpp"
#include "kernels/derivative/path_sweep.hpp"
#include "kernels/derivative/state_products.hpp"
#include "kernels/derivative/tree_products.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/crba.hpp"

namespace dyn::kernels {

/// Whether the inertia of body i is needed after its joint has been eliminated: the parent receives it, or the force through a joint with a varying
/// subspace is computed from it.
template <class Joint, class Order>
bool needsRest(const Order& order, int i) {
  return Joint::has_bias || !order.isRoot(i);
}

/// (2): eliminates the degrees of freedom of body i, the last one first. Calls use(k, column, inverse, row) for each, with inverse = 1 / D.
template <class Joint, class S, class Order, class Use>
void eliminateJoint(const Order& order, Workspace<S>& w, ArticulatedInertia<S>& IA, int i, int iv, Use&& use) {
  if constexpr (Joint::is_free) {
    if (isPlainFloatingBase<Joint>(order, i)) {
      const AxesElimination<true, S> axes(order, IA, i, iv, w.failed);
      eachAxis([&](int p) { use(axes.axis(p), UnitColumn<S>{axes.axis(p)}, axes.inverse(p), axes.inverse(p) * axes.column(p)); });
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

/// (1) and (2), after columnsOutward: calls enter(dof, inverse, row). w.failed has, by lane, the first body whose pivot vanished, or 0.
template <class S, class Order, class Enter>
void articulatedFactors(const Order& order, Workspace<S>& w, Enter&& enter) {
  for (int& body : w.failed) body = 0;
  order.backward(passing(w.IA), [&]<class Joint>(const Joint&, int i, int iv, auto&& inertia) {
    const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(mass, h, I));
    eliminateJoint<Joint>(order, w, IA, i, iv, [&](int k, const auto&, const S& inverse, const Force<S>& row) { enter(iv + k, inverse, row); });
    if (order.isRoot(i)) return;
    if (order.hasOffset(i)) IA = IA.shifted(w.r[i]);
    inertia.give(IA);
  });
}

/// (1) to (3): writes the factors of M^-1 to d.factors. w has the evaluated joints. Quad: the pack whose lanes hold the joints of a lane group.
template <class Wide, class Quad = Wide, class S>
void treeFactors(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  withRecursion<Quad>(m, w, d, m.lane_groups.uses.derivatives, [&](const auto& r) {
    using Recursion = std::remove_cvref_t<decltype(r)>;
    using T = typename Recursion::Scalar;
    columnsOutward(r.order, r.order.w);
    T* inverses = r.out(d.factors.inverse);
    articulatedFactors(r.order, r.order.w, [&](int dof, const T& inverse, const Force<T>& row) {
      inverses[dof] = inverse;
      r.d.dof_force[dof].by_a = row;
    });
    if constexpr (Recursion::over_lane_groups) {
      r.put(inverses, d.factors.inverse);
      laneGroupFactorsSweep(r, d.factors.U);
    } else {
      factorsSweep<Wide>(r, d);
    }
    r.failures(w.failed);
  });
}

/// (4): M^-1 from its factors, n x n with room for a pack behind it, symmetric to the last bit.
template <class Wide, class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, const Rows<S>& out) {
  downTheTree<Wide, true>(m, factors, factors.U, FromZeros(), out);
  mirrorUpper<Wide>(out, m.nvx);
}
/// The same for states in packs: entries on the diagonal and below.
template <class S>
void inverseOfMassMatrix(const CompactImpl& m, const TreeFactors<S>& factors, const ProductScratch<S>& scratch, const Rows<S>& out) {
  inChains(m, factors, scratch, [&]<int columns>(const ChainProduct<S>& chain, int j) {
    chain.template write<columns, 1>(j, chain.pathOf(j + columns - 1), chain.template projectionsOfU<columns>(j), out[j], out.stride);
  });
}

}  // namespace dyn::kernels
