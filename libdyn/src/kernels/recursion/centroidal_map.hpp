// SPDX-License-Identifier: BSD-2-Clause
// The centroidal momentum map (Orin and Goswami 2008), from composite inertias of subtrees, each about its joint's origin, in world axes.
//
// Columns are moved to the centre of mass last. The vector y leads from the joint's origin to the centre. No position in the world enters.
#pragma once

#include "kernels/body/centroidal_state.hpp"
#include "kernels/pack/six_numbers.hpp"
// Specialisations come before the templates that use them.
#include "kernels/recursion/crba.hpp"

namespace dyn::kernels {

/// A tree as its root's joint moves it: mass, first moment and inertia about that joint's origin, in world axes, and y (`place`).
template <class S>
struct WholeTree {
  S mass;
  Vec3<S> h;
  Sym3<S> I;
  Vec3<S> place;

  /// First moment about the centre of mass of the whole model. It is zero if this is the only tree.
  Vec3<S> apart() const { return h - mass * place; }
  Force<S> about(const Force<S>& f) const { return {f.linear, f.angular - cross(place, f.linear)}; }
};

/// Calls put(k, force) for the columns of a floating base with axes R.
template <class S, class Put>
void floatingBaseColumns(const WholeTree<S>& tree, const Mat3<S>& R, Put&& put) {
  const Vec3<S> apart = tree.apart();
  for (int k = 0; k < 3; ++k) put(k, Force<S>{tree.mass * R.col(k), cross(apart, R.col(k))});
  for (int k = 0; k < 3; ++k) put(3 + k, tree.about({cross(R.col(k), tree.h), tree.I * R.col(k)}));
}

template <class To, class S>
CentroidalState<To> inNumbers(const CentroidalState<S>& x) {
  const auto numbers = [](const Force<S>& f) { return Force<To>{cast<To>(f.linear), cast<To>(f.angular)}; };
  return {numbers(x.momentum), numbers(x.rate), cast<To>(x.inertia), numberOf(x.mass)};
}

/// Handles trees and columns of the map for an order that visits bodies. The map has numbers of S.
template <class S>
struct BodyMap {
  S* map;

  const Motion<S>& ofFirst(const Motion<S>* array) const { return array[1]; }
  template <class T>
  const T& own(int, const T& x) const {
    return x;
  }
  template <class T>
  const T& sum(const T& x) const {
    return x;
  }
  void put(int, int iv, int k, const Force<S>& f) const { putSix(f, map + 6 * (iv + k)); }
  void putFloatingBase(int, int iv, const WholeTree<S>& tree, const Mat3<S>& R) const {
    floatingBaseColumns(tree, R, [&](int k, const Force<S>& f) { putSix(f, map + 6 * (iv + k)); });
  }
};

/// Computes the columns of the map, the momentum, and the inertia of the whole model. The joints must have been evaluated before. Walk is BodyMap, or
/// the same interface for another order.
template <class S, BodyOrder Order, class Walk>
CentroidalState<S> centroidalMap(const Order& order, const S* v, const Walk& walk) {
  Workspace<S>& w = order.w;
  // `origin` and `omega` hold position and velocity of a root's joint origin, and the root's angular velocity. `place` holds y of every body later.
  Motion<S>* const origin = w.acc;
  Vec3<S>*const omega = w.w, *const place = w.w;

  order.forward(passingAxes(order, w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& axes, auto&&... products) {
    Mat3<S> R;
    if (isFloatingBase<Joint>(order, i)) {
      const SE3<S> X = placedInParent<S>(joint, cast<S>(order.constants(i).placement));
      R = X.R;
      w.r[i] = X.p;
      axes.leave(R);
      (products.leave(R), ...);
    } else {
      R = placeAligned<S, Orthonormalisation::from_columns>(joint, order, order.constants(i).placement, i, w, axes, products...);
      writeColumns(joint, R, w.dof + iv);
    }
    if (!order.isRoot(i)) return;
    const Motion<S> moving = joint.timesIn(R, v + iv);
    origin[i] = {w.r[i], moving.linear};
    omega[i] = moving.angular;
  });
  // Positions and velocities of other roots are relative to the first root.
  const Motion<S> first = walk.ofFirst(origin);

  S mass(0);
  Vec3<S> moment;
  order.backward(passing(w.mass, w.h, w.Io), [&]<class Joint>(const Joint&, int i, int iv, auto&& masses, auto&& moments, auto&& inertias) {
    const AlignedInertia<S> own = withInertia(order, i, [&](const auto& c) -> AlignedInertia<S> {
      const Mat3<S>& R = w.R[i];
      return {S(c.mass), R * c.h, congruence(R, c.origin)};
    });
    const S m = masses.with(own.mass);
    const Vec3<S> h = moments.with(own.h);
    const Sym3<S> I = inertias.with(own.Io);
    if (!isFloatingBase<Joint>(order, i))
      for (int k = iv; k < iv + nvOf<Joint>(order, i); ++k) w.dof[k].W = compositeForce<Joint>(w.dof[k].column, m, h, I);
    if (!order.isRoot(i)) return giveComposite(order, i, inertias, moments, masses, m, h, I);
    w.mass[i] = m;
    w.h[i] = h;
    w.Io[i] = I;
    mass += walk.own(i, m);
    moment += walk.own(i, h + m * (origin[i].linear - first.linear));
  });
  mass = walk.sum(mass);
  const Vec3<S> centre = (S(1) / mass) * walk.sum(moment);

  Force<S> momentum{};
  Sym3<S> inertia{};
  order.forward(passing(place), [&]<class Joint>(const Joint&, int i, int iv, auto&& y) {
    Vec3<S> here;
    if (order.isRoot(i)) {
      const Motion<S> seen = origin[i] - first;
      here = centre - seen.linear;
      const WholeTree<S> tree{w.mass[i], w.h[i], w.Io[i], here};
      inertia += walk.own(i, shiftedInertia(tree.I, tree.mass, tree.h, -here));
      // The whole tree moves with its origin's velocity, which gives no angular momentum about the tree's own centre of mass.
      const Force<S> turning = tree.about({cross(omega[i], tree.h), tree.I * omega[i]});
      momentum += walk.own(i, Force<S>{turning.linear + tree.mass * origin[i].angular, turning.angular + cross(tree.apart(), seen.angular)});
      if (isFloatingBase<Joint>(order, i)) {
        y.leave(here);
        return walk.putFloatingBase(i, iv, tree, w.R[i]);
      }
    } else {
      here = y.get() - w.r[i];
    }
    y.leave(here);
    for (int k = 0; k < nvOf<Joint>(order, i); ++k) {
      const Force<S>& U = w.dof[iv + k].W;
      const Force<S> column{U.linear, U.angular - cross(here, U.linear)};
      walk.put(i, iv, k, column);
      if (!order.isRoot(i)) momentum += walk.own(i, v[iv + k]) * column;
    }
  });
  return {walk.sum(momentum), {}, walk.sum(inertia), mass};
}

}  // namespace dyn::kernels
