// SPDX-License-Identifier: BSD-2-Clause
// Poses, velocities and accelerations, from the root outward.
#pragma once

#include "kernels/order/world_poses.hpp"

namespace dyn::kernels {

/// Acceleration of a point of a body relative to the body's origin.
template <class S>
Vec3<S> beyondOrigin(const Vec3<S>& angular, const Vec3<S>& w, const Vec3<S>& point) {
  return cross(angular, point) + cross(w, cross(w, point));
}

/// Writes w.oM, and w.rel if it is wanted. With v it writes both, and w.v. With a it writes w.a, and w.sliding if that is not null. A spatial
/// acceleration contains w x v, whose rounding error would remain in the origin's classical acceleration. That one is therefore summed up from
/// w.sliding, see originAccelerationOf().
template <Poses poses = Poses::in_parents_too, class S, BodyOrder Order>
void forwardKinematics(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.v[0] = w.a[0] = {};
  order.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    if (!v) return placeInWorld<poses>(joint, order, i, w);
    const SE3<S> rel = placedInParent<S>(joint, order.constants(i).placement);
    w.rel[i] = rel;
    w.oM[i] = placedInWorld(order, w, rel, i);
    const Motion<S> s = joint.times(v + iv);
    const Motion<S> carried = rel.actInv(order.parent(w.v, i));
    w.v[i] = carried + s;
    if (!a) return;
    Motion<S> ds = joint.times(a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();
    // Revolute joints do not slide.
    if constexpr (!Joint::about_z) {
      if (w.sliding) w.sliding[i] = ds.linear + cross(carried.angular + carried.angular + s.angular, s.linear);
    }
    w.a[i] = rel.actInv(order.parent(w.a, i)) + (ds + carried.cross(s));
  });
}

}  // namespace dyn::kernels
