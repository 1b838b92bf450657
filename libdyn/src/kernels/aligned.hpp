// Aligned frames: the axes of the tree's root body (of the world, when the root does not fly) with the origin at each joint.
//
// Inertias are rotated once, shifts from joint to joint are pure translations formed as R_parent * p_local, and no world position
// enters: results stay exact however far the base stands from the origin.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// A free body on the world carries its own axes: R = 1 there, and the world's directions are turned instead.
template <class Joint, class Order>
bool isFlyingRoot(const Order& order, int i) {
  return Joint::is_free && order.isRoot(i);
}

/// Writes w.rel, w.R and w.r of body i.
template <class S, class Joint, class Order>
void placeAligned(const Joint& joint, const Order& order, const SE3<S>& placement, int i, Workspace<S>& w) {
  const SE3<S> rel = placedInParent<S>(joint, placement);
  w.rel[i] = rel;
  if (isFlyingRoot<Joint>(order, i)) {
    w.R[i] = Mat3<S>::identity();
    w.r[i] = {};
  } else {
    const Mat3<S>& parent = order.parent(w.R, i);
    w.R[i] = composedRotation(parent, rel.R);
    w.r[i] = parent * rel.p;
  }
}

/// Column k of the motion subspace in aligned axes.
template <class S, class Joint>
Motion<S> alignedColumn(const Joint& joint, int k, const Mat3<S>& R) {
  const Motion<S> s = joint.column(k);
  Motion<S> out;
  if constexpr (Joint::has_linear) out.linear = R * s.linear;
  if constexpr (Joint::has_angular) out.angular = R * s.angular;
  return out;
}

}  // namespace dyn::kernels
