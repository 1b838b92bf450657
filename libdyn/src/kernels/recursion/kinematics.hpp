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

/// Writes w.oM, and w.rel if it is wanted. With v it also writes w.v, and with a it writes w.a, and w.sliding if that is not null. A spatial
/// acceleration contains w x v, whose rounding error would remain in the origin's classical acceleration. That one is therefore summed up from
/// w.sliding, see originAccelerationOf(). R, r and p are as in rnea.hpp, X is the motion transform from the parent to body i, and m x s is the cross
/// product of motions (Featherstone 2008, sec. 4.3):
///
///   (1)  v = X v_p + S v                          X m = (R^T (m.linear + m.angular x r), R^T m.angular)
///   (2)  a = X a_p + S a + b + (X v_p) x (S v)
template <Poses poses = Poses::in_parents_too, class S, BodyOrder Order>
void forwardKinematics(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.v[0] = w.a[0] = {};
  if (!v) return order.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int) { placeInWorld<poses>(joint, order, i, w); });
  order.forward(passing(w.v, w.a), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& velocity, auto&& acceleration) {
    placeInWorld<poses>(joint, order, i, w);
    constexpr bool has_rel = poses == Poses::in_parents_too || !Order::lanes_are_states || !Joint::about_z;  // placeInWorld() has written w.rel
    const auto moved = [&](const Motion<S>& m, auto&& use) {
      Vec3<S> linear = m.linear;
      alongOffset<S, Joint>(
          order, i,
          [&] {
            if constexpr (has_rel) {
              return originInward<S, Joint>(order, i);
            } else {
              return originOutward<S>(joint, order, i);
            }
          },
          [&](const auto& r) { addCross(linear, m.angular, r); });
      use(linear);
    };
    const auto rotated = [&](auto&& use) {
      if constexpr (has_rel) {
        withRotationInward<S>(joint, order, i, use);
      } else {
        withRotationOutward<S>(joint, order, i, use);
      }
    };
    Motion<S> carried{}, a_carried{};
    if (!order.isRoot(i)) {  // the world does not move
      const Motion<S>&vp = velocity.get(), &ap = acceleration.get();
      moved(vp, [&](const Vec3<S>& v_linear) {
        if (!a) return rotated([&](const auto& R) { carried = {transposeTimes(R, v_linear), transposeTimes(R, vp.angular)}; });
        moved(ap, [&](const Vec3<S>& a_linear) {
          rotated([&](const auto& R) {
            carried = {transposeTimes(R, v_linear), transposeTimes(R, vp.angular)};
            a_carried = {transposeTimes(R, a_linear), transposeTimes(R, ap.angular)};
          });
        });
      });
    }
    const Motion<S> s = joint.times(v + iv);
    velocity.leave(carried + s);
    if (!a) return;
    Motion<S> ds = joint.times(a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();
    // Revolute joints do not slide.
    if constexpr (!Joint::about_z) {
      if (w.sliding) w.sliding[i] = ds.linear + cross(carried.angular + carried.angular + s.angular, s.linear);
    }
    acceleration.leave(a_carried + (ds + carried.cross(s)));
  });
}

}  // namespace dyn::kernels
