// Poses, velocities and accelerations, from the root outward.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// w.oM of body i from its parent's and w.rel.
template <class S, class Order>
void placeInWorld(const Order& order, Workspace<S>& w, const SE3<S>& rel, int i) {
  const SE3<S>& parent = order.parent(w.oM, i);
  // Poses have no inertias to turn: it is enough that long chains do not drift.
  const bool renew = order.depth(i) % 16 == 0;
  w.oM[i] = {renew ? composedRotation(parent.R, rel.R) : parent.R * rel.R, parent.act(rel.p)};
}

/// w.rel and w.oM; with v, w.v; with a, w.a.
template <class S, class Order>
void forwardKinematics(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.v[0] = w.a[0] = {};
  order.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const SE3<S> rel = placedInParent<S>(joint, order.constants(i).placement);
    w.rel[i] = rel;
    placeInWorld(order, w, rel, i);
    if (!v) return;
    const Motion<S> s = joint.times(v + iv);
    const Motion<S> carried = rel.actInv(order.parent(w.v, i));
    w.v[i] = carried + s;
    if (!a) return;
    Motion<S> ds = joint.times(a + iv) + carried.cross(s);
    if constexpr (Joint::has_bias) ds += joint.bias();
    w.a[i] = rel.actInv(order.parent(w.a, i)) + ds;
  });
}

}  // namespace dyn::kernels
