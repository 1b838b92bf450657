// SPDX-License-Identifier: BSD-2-Clause
// The recursive Newton-Euler algorithm (Luh, Walker and Paul 1980; Featherstone 2008, sec. 5.3): tau = M(q) a + C(q, v) v + g(q). O(n).
//
// The acceleration of a body is the classical one of its origin, which is the spatial acceleration plus w x v. Linear velocities do not enter, so a
// fast base costs no digits. All vectors of body i are in its own axes. R rotates from these to the parent's axes, r is the origin of i in the
// parent's frame, (S_v, S_w) is the joint's motion subspace, b is its bias (dS/dt) v, and p is the parent.
//
//   (1)  w      = R^T w_p + S_w v                                                     angular velocity
//   (2)  domega = R^T domega_p + S_w a + b_w + (R^T w_p) x (S_w v)                    angular acceleration
//   (3)  origin = R^T (origin_p + domega_p x r + w_p x (w_p x r)) + S_v a + b_v + (R^T w_p + w) x (S_v v)
//
// The recursion starts from origin_0 = -gravity at the world. m is the mass, c the centre of mass, I the inertia about it, fext the external force.
//
//   (4)  f.linear  = m (origin + domega x c + w x (w x c)) - fext.linear + sum over children of f'.linear
//   (5)  f.angular = I domega + w x (I w) + c x m (...)    - fext.angular + sum over children of f'.angular
//   (6)  tau       = S_v^T f.linear + S_w^T f.angular
//   (7)  f'        = (R f.linear, R f.angular + r x R f.linear)                       handed to the parent
#pragma once

#include "kernels/body/rotation_rates.hpp"
#include "kernels/order/joint_frames.hpp"

namespace dyn::kernels {

/// Adds to `sum` the acceleration of the point r of a body relative to the body's origin.
template <class S>
void addAccelerationAt(Vec3<S>& sum, const Vec3<S>& w, const Vec3<S>& a, const Vec3<S>& r) {
  sum = RotationRates<S>(w, a).at(sum, r);
}
template <class S, int axis>
void addAccelerationAt(Vec3<S>& sum, const Vec3<S>& w, const Vec3<S>& a, const AxisOffset<S, axis>& r) {
  addCross(sum, a, r);
  addCentripetal(sum, w, r);
}

/// Computes the angular velocity w.w, the angular acceleration and the classical acceleration of each body's origin, in the body's own axes:
/// w.acc[i] = (classical linear, angular) acceleration, less gravity.
template <class S, BodyOrder Order>
void rneaOutward(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.w[0] = {};
  w.acc[0] = {-order.gravity(), {}};
  order.forward(passing(w.w, w.acc), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&& acceleration) {
    const Motion<S>& ap = acceleration.get();
    const bool root = order.isRoot(i);  // the world does not turn
    Vec3<S> w_carried{}, domega{}, origin = ap.linear;
    if (!root)
      alongOffset<S, Joint>(
          order, i, [&] { return originOutward<S>(joint, order, i); },
          [&](const auto& r) { addAccelerationAt(origin, turning.get(), ap.angular, r); });
    withRotationOutward<S>(joint, order, i, [&](const auto& R) {
      origin = transposeTimes(R, origin);
      if (root) return;
      w_carried = transposeTimes(R, turning.get());
      domega = transposeTimes(R, ap.angular);
    });
    const Motion<S> s = joint.times(v + iv);
    Motion<S> ds = joint.times(a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();

    const Vec3<S> omega = turnedInOwnAxes<Joint>(w_carried, s);
    if constexpr (Joint::about_z) {
      domega += crossZ(w_carried, s.angular[2]);
      addAt(domega, 2, ds.angular[2]);
    } else if constexpr (Joint::has_angular) {
      domega += ds.angular + cross(w_carried, s.angular);
    }
    if constexpr (Joint::has_linear) origin += ds.linear + cross(w_carried + omega, s.linear);
    turning.leave(omega);
    acceleration.leave({origin, domega});
  });
}

/// Computes the force f that moves each body and its subtree, tau = S^T f, and each body's force on its parent.
template <class S, BodyOrder Order, class External = std::nullptr_t>
void rneaInward(const Order& order, Workspace<S>& w, S* tau, External fext = {}) {
  order.backward(passing(w.f), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& force) {
    const auto& [origin, domega] = w.acc[i];
    const RotationRates<S> rates(w.w[i], domega);
    Force<S> own = withInertia(order, i, [&](const auto& c) -> Force<S> {
      const Vec3<S> torque = rates.torque(c.rotational), linear = c.mass * rates.at(origin, c.com);
      return {linear, torque + cross(c.com, linear)};
    });
    if constexpr (!std::is_null_pointer_v<External>)
      if (fext) own -= fext[i];
    const Force<S> f = force.with(own);
    joint.project(f, tau + iv);
    Force<S> on_parent = f;
    if (!order.isRoot(i)) {
      withRotationInward<S>(joint, order, i, [&](const auto& R) { on_parent = {R * f.linear, R * f.angular}; });
      alongOffset<S, Joint>(
          order, i, [&] { return originInward<S, Joint>(order, i); }, [&](const auto& r) { addCross(on_parent.angular, r, on_parent.linear); });
    }
    // Also done at roots, though nobody reads it: otherwise compilers defer the sum and spill it to memory.
    force.give(on_parent);
  });
}

}  // namespace dyn::kernels
