// Newton and Euler's recursion with classical accelerations: linear velocities do not enter, so a fast base costs no digits.
#pragma once

#include "kernels/joint_frames.hpp"
#include "kernels/spin.hpp"

namespace dyn::kernels {

/// Adds what the point at r of a body has more than its origin.
template <class S>
void addAccelerationAt(Vec3<S>& sum, const Vec3<S>& w, const Vec3<S>& a, const Vec3<S>& r) {
  sum = Spin<S>(w, a).at(sum, r);
}
template <class S, int axis>
void addAccelerationAt(Vec3<S>& sum, const Vec3<S>& w, const Vec3<S>& a, const AxisLever<S, axis>& r) {
  addCross(sum, a, r);
  addCentripetal(sum, w, r);
}

/// Angular velocity w, angular acceleration and classical acceleration of each body's origin, in its own axes.
/// w.acc[i] = (classical linear, angular) acceleration, less gravity.
template <class S, class Order>
void rneaOutward(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.w[0] = {};
  w.acc[0] = {-order.gravity(), {}};
  order.forward(passing(w.w, w.acc), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&& acceleration) {
    const Motion<S>& ap = acceleration.get();
    const bool root = order.isRoot(i);  // the world does not turn
    Vec3<S> w_carried{}, domega{}, origin = ap.linear;
    if (!root)
      alongLever<S, Joint>(
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

/// The force that moves each body, tau = S^T f, and each body's force on its parent.
template <class S, class Order, class External = std::nullptr_t>
void rneaInward(const Order& order, Workspace<S>& w, S* tau, External fext = {}) {
  order.backward(passing(w.f), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& force) {
    const auto& [origin, domega] = w.acc[i];
    const Spin<S> spin(w.w[i], domega);
    const Vec3<S> torque = spin.torque(order.constants(i).rotational);
    const Vec3<S> com = order.constants(i).com, linear = order.constants(i).mass * spin.at(origin, com);
    Force<S> own{linear, torque + cross(com, linear)};
    if constexpr (!std::is_null_pointer_v<External>)
      if (fext) own -= fext[i];
    const Force<S> f = force.with(own);
    joint.project(f, tau + iv);
    Force<S> on_parent = f;
    if (!order.isRoot(i)) {
      withRotationInward<S>(joint, order, i, [&](const auto& R) { on_parent = {R * f.linear, R * f.angular}; });
      alongLever<S, Joint>(
          order, i, [&] { return originInward<S, Joint>(order, i); }, [&](const auto& r) { addCross(on_parent.angular, r, on_parent.linear); });
    }
    // Roots as well, to the world, which does not ask: compilers would put off what only others give, and its numbers into memory until then.
    force.give(on_parent);
  });
}

}  // namespace dyn::kernels
