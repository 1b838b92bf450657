// The mass matrix from composite inertias in aligned frames (Featherstone 2008, ch. 6).
#pragma once

#include "kernels/aligned.hpp"

namespace dyn::kernels {

/// Rotational inertia about a point at distance r from the old origin (old origin = new origin + r), first moment h, mass m.
template <class S>
Sym3<S> shiftedInertia(const Sym3<S>& I, const S& mass, const Vec3<S>& h, const Vec3<S>& r) {
  const Vec3<S> k = h + S(0.5) * mass * r;  // I + [..] = I - (h r^T + r h^T + m r r^T) + trace part, symmetric in h + m r / 2
  const S t = S(2) * dot(k, r), kx = S(2) * k.x * r.x, ky = S(2) * k.y * r.y, kz = S(2) * k.z * r.z;
  return I + Sym3<S>{t - kx, -(k.x * r.y + r.x * k.y), -(k.x * r.z + r.x * k.z), t - ky, -(k.y * r.z + r.y * k.z), t - kz};
}

/// Placements, and the columns of the motion subspaces.
template <Renewal renewal = Renewal::whole, class S, class Order>
void columnsOutward(const Order& order, Workspace<S>& w) {
  order.forward(passingAxes(order, w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&&... axes) {
    const Mat3<S> R = placeAligned<S, renewal>(joint, order, order.constants(i).placement, i, w, axes...);
    writeColumns(joint, R, w.dof + iv);
  });
}

/// What accelerates a subtree along a column of its joint: mass, first moment and inertia about the joint's origin.
template <class Joint, class S>
Force<S> compositeForce(const Motion<S>& column, const S& mass, const Vec3<S>& h, const Sym3<S>& I) {
  Force<S> F{};
  if constexpr (Joint::has_angular) F = {cross(column.angular, h), I * column.angular};
  if constexpr (Joint::has_linear) F += Force<S>{mass * column.linear, cross(h, column.linear)};
  return F;
}

/// Of body i with its subtree, to its parent.
template <class Order, class Inertias, class Moments, class Masses, class S>
void giveComposite(const Order& order, int i, Inertias& inertias, Moments& moments, Masses& masses, const S& mass, const Vec3<S>& h,
                   const Sym3<S>& I) {
  const Vec3<S>& r = order.w.r[i];
  const bool has_lever = order.hasLever(i);
  inertias.give(has_lever ? shiftedInertia(I, mass, h, r) : I);
  moments.give(has_lever ? h + mass * r : h);
  masses.give(mass);
}

/// The block of a flying root, whose columns are the unit vectors: mass, first moment and inertia themselves.
template <class S, class Order, class Entry>
void enterFlyingRoot(const Order& order, const Entry& at, int iv, const S& mass, const Vec3<S>& h, const Sym3<S>& I) {
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

/// M of the expanded coordinates, n x n: entries of joints on one path to the root, both triangles. The others are zero and never
/// written: M must have been zero once.
template <class S, class Order>
void massMatrix(const Order& order, Workspace<S>& w, typename Order::Entries* M) {
  columnsOutward<Renewal::from_columns>(order, w);
  const auto composite = passing(w.mass, w.h, w.Io);
  order.backward(composite, [&]<class Joint>(const Joint&, int i, int iv, auto&& masses, auto&& moments, auto&& inertias) {
    const auto body = alignedInertia<Joint>(order, w, i);
    const S mass = masses.with(body.mass);
    const Vec3<S> h = moments.with(body.h);
    const Sym3<S> I = inertias.with(body.Io);
    auto at = order.entry(M, i, iv);
    if constexpr (Joint::is_free)
      if (order.isRoot(i)) return enterFlyingRoot(order, at, iv, mass, h, I);
    Force<S> F[most_nv<Joint>];
    const int nv = nvOf<Joint>(order, i);
    for (int k = 0; k < nv; ++k) {
      const Motion<S>& column = w.dof[iv + k].S_;
      F[k] = compositeForce<Joint>(column, mass, h, I);
      for (int l = 0; l < k; ++l) at.enter(k, l, Column<Joint, S>{w.dof[iv + l].S_}.along(F[k]));
      at.enter(k, k, Column<Joint, S>{column}.along(F[k]) + order.armature(iv + k));
    }
    if (order.isRoot(i)) return;
    giveComposite(order, i, inertias, moments, masses, mass, h, I);
    const auto stepAlong = [&](const auto& step) {
      if (step.hasLever()) {
        const Vec3<S> r = step.lever(w.r);
        for (int k = 0; k < nv; ++k) addCross(F[k].angular, r, F[k].linear);
      }
      if (step.flyingRoot()) {
        for (int k = 0; k < nv; ++k) step.enterFlying(k, F[k]);
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
    const auto turnAlong = [&](const Vec3<S>* lever, const Motion<S>& column, const auto& enter) {
      for (int k = 0; k < nv; ++k) {
        if (lever) addCross(F[k].angular, *lever, F[k].linear);
        enter(k, dot(column.angular, F[k].angular));
      }
    };
    const auto begin = [&] {
      for (int k = 0; k < nv; ++k) F[k] = compositeForce<Joint>(w.dof[iv + k].S_, mass, h, I);
    };
    at.climb(begin, stepAlong, turnAlong);
  });
}

}  // namespace dyn::kernels
