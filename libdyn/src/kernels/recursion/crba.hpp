// SPDX-License-Identifier: BSD-2-Clause
// The composite-rigid-body algorithm (Featherstone 2008, ch. 6): the mass matrix M(q). O(n depth).
//
// All vectors are in aligned axes (aligned.hpp), at the joint's origin. r is the joint offset of body i, and S is a column of its joint.
//
//   (1)  (m, h, I) = own mass, first moment, inertia about the origin + those of the children, each moved by its r
//   (2)  F    = (m S_v - h x S_w, h x S_v + I S_w)                                    force that accelerates the subtree along S
//   (3)  M_kk = S^T F + armature,   M_kl = S_l^T F within the joint
//   (4)  on the way to the root:  F.angular += r x F.linear,   M_kl = M_lk = S_l^T F with the columns S_l that are met
#pragma once

#include "kernels/recursion/aligned.hpp"

namespace dyn::kernels {

/// Rotational inertia about a new origin, where old origin = new origin + r. I and the first moment h are about the old origin.
template <class S>
Sym3<S> shiftedInertia(const Sym3<S>& I, const S& mass, const Vec3<S>& h, const Vec3<S>& r) {
  const Vec3<S> k = h + S(0.5) * mass * r;  // I + [..] = I - (h r^T + r h^T + m r r^T) + trace part, symmetric in h + m r / 2
  const S t = S(2) * dot(k, r), kx = S(2) * k.x * r.x, ky = S(2) * k.y * r.y, kz = S(2) * k.z * r.z;
  return I + Sym3<S>{t - kx, -(k.x * r.y + r.x * k.y), -(k.x * r.z + r.x * k.z), t - ky, -(k.y * r.z + r.y * k.z), t - kz};
}

/// Computes placements and the columns of the motion subspaces.
template <Orthonormalisation orthonormalisation = Orthonormalisation::whole, class S, BodyOrder Order>
void columnsOutward(const Order& order, Workspace<S>& w) {
  order.forward(passingAxes(order, w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&&... axes) {
    const Mat3<S> R = placeAligned<S, orthonormalisation>(joint, order, order.constants(i).placement, i, w, axes...);
    writeColumns(joint, R, w.dof + iv);
  });
}

/// The force that accelerates a subtree along a column of its joint, equation (2). mass, h and I are the subtree's, about the joint's origin.
template <class Joint, class S>
Force<S> compositeForce(const Motion<S>& column, const S& mass, const Vec3<S>& h, const Sym3<S>& I) {
  Force<S> F{};
  if constexpr (Joint::has_angular) F = {cross(column.angular, h), I * column.angular};
  if constexpr (Joint::has_linear) F += Force<S>{mass * column.linear, cross(h, column.linear)};
  return F;
}

/// Hands the composite inertia of body i and its subtree to the parent, moved to the parent's origin.
template <class Order, class Inertias, class Moments, class Masses, class S>
void giveComposite(const Order& order, int i, Inertias& inertias, Moments& moments, Masses& masses, const S& mass, const Vec3<S>& h,
                   const Sym3<S>& I) {
  const Vec3<S>& r = order.w.r[i];
  const bool has_offset = order.hasOffset(i);
  inertias.give(has_offset ? shiftedInertia(I, mass, h, r) : I);
  moments.give(has_offset ? h + mass * r : h);
  masses.give(mass);
}

/// Enters the diagonal block of a floating base. Its columns are the unit vectors, so the entries are mass, first moment and inertia themselves.
template <class S, class Order, class Entry>
void enterFloatingBaseBlock(const Order& order, const Entry& at, int iv, const S& mass, const Vec3<S>& h, const Sym3<S>& I) {
  const Mat3<S> inertia = I.matrix();
  at.enterOwn([&](auto&& put) {
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3, last = (k + 2) % 3;
      put(k, k, mass + order.armature(iv + k));
      put(3 + k, next, -h[last]);
      put(3 + k, last, h[next]);
      for (int l = 0; l < k; ++l) put(3 + k, 3 + l, inertia.col(l)[k]);
      put(3 + k, 3 + k, inertia.col(k)[k] + order.armature(iv + 3 + k));
    }
  });
}

/// Computes M in expanded coordinates, n x n. It writes both triangles, for joints on one root path. The other entries are zero and never written, so
/// M must be zero before the first call.
template <class S, BodyOrder Order>
void massMatrix(const Order& order, Workspace<S>& w, typename Order::Entries* M) {
  columnsOutward<Orthonormalisation::from_columns>(order, w);
  const auto composite = passing(w.mass, w.h, w.Io);
  order.backward(composite, [&]<class Joint>(const Joint&, int i, int iv, auto&& masses, auto&& moments, auto&& inertias) {
    const auto body = alignedInertia<Joint>(order, w, i);
    const S mass = masses.with(body.mass);
    const Vec3<S> h = moments.with(body.h);
    const Sym3<S> I = inertias.with(body.Io);
    auto at = order.entry(M, i, iv);
    if constexpr (Joint::is_free)
      if (order.isRoot(i)) return enterFloatingBaseBlock(order, at, iv, mass, h, I);
    Force<S> F[most_nv<Joint>];
    const int nv = nvOf<Joint>(order, i);
    for (int k = 0; k < nv; ++k) {
      const Motion<S>& column = w.dof[iv + k].column;
      F[k] = compositeForce<Joint>(column, mass, h, I);
      for (int l = 0; l < k; ++l) at.enter(k, l, Column<Joint, S>{w.dof[iv + l].column}.along(F[k]));
      at.enter(k, k, Column<Joint, S>{column}.along(F[k]) + order.armature(iv + k));
    }
    if (order.isRoot(i)) return;
    giveComposite(order, i, inertias, moments, masses, mass, h, I);
    const auto stepAlong = [&](const auto& step) {
      if (step.hasOffset()) {
        const Vec3<S> r = step.offset(w.r);
        for (int k = 0; k < nv; ++k) addCross(F[k].angular, r, F[k].linear);
      }
      if (step.floatingBase()) {
        for (int k = 0; k < nv; ++k) step.enterFloatingBase(k, F[k]);
        return;
      }
      const auto enterAll = [&](auto value) {
        int l = 0;
        do {
          for (int k = 0; k < nv; ++k) step.enter(k, l, value(step.column(w, l), F[k]));
        } while (++l < step.nv());
      };
      if (step.turnsOnly()) {
        enterAll([](const Motion<S>& column, const Force<S>& f) { return dot(column.angular, f.angular); });
      } else {
        enterAll([](const Motion<S>& column, const Force<S>& f) { return dot(column, f); });
      }
    };
    const auto turnAlong = [&](const Vec3<S>* offset, const Motion<S>& column, const auto& enter) {
      for (int k = 0; k < nv; ++k) {
        if (offset) addCross(F[k].angular, *offset, F[k].linear);
        enter(k, dot(column.angular, F[k].angular));
      }
    };
    const auto begin = [&] {
      for (int k = 0; k < nv; ++k) F[k] = compositeForce<Joint>(w.dof[iv + k].column, mass, h, I);
    };
    at.climb(begin, stepAlong, turnAlong);
  });
}

}  // namespace dyn::kernels
