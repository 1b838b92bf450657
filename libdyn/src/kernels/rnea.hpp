// Newton and Euler's recursion with classical accelerations: linear velocities do not enter, so a fast base costs no digits.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// Angular velocity w, angular acceleration and classical acceleration of each body's origin, in its own axes; then the force that moves
/// it. w.a[i] = (classical linear, angular) acceleration, less gravity.
template <class S, class Order>
void rneaOutward(const Order& order, Workspace<S>& w, const S* v, const S* a, const Force<S>* fext) {
  w.w[0] = {};
  w.a[0] = {-order.gravity(), {}};
  order.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const auto& c = order.constants(i);
    const SE3<S> rel = placedInParent<S>(joint, c.placement);
    w.rel[i] = rel;

    const Vec3<S>& wp = order.parent(w.w, i);
    const Motion<S>& ap = order.parent(w.a, i);
    const Vec3<S> w_carried = transposeTimes(rel.R, wp);
    const Motion<S> s = joint.times(v + iv);
    Motion<S> ds = joint.times(a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();

    const Vec3<S> omega = [&] {
      if constexpr (Joint::about_z) {
        return Vec3<S>{w_carried.x, w_carried.y, w_carried.z + s.angular.z};
      } else {
        return turnedBy<Joint>(w_carried, s);
      }
    }();
    Vec3<S> domega = transposeTimes(rel.R, ap.angular);
    Vec3<S> origin = transposeTimes(rel.R, ap.linear + cross(ap.angular, rel.p) + cross(wp, cross(wp, rel.p)));
    if constexpr (Joint::about_z) {
      domega += Vec3<S>{w_carried.y * s.angular.z, -(w_carried.x * s.angular.z), ds.angular.z};
    } else if constexpr (Joint::has_angular) {
      domega += ds.angular + cross(w_carried, s.angular);
    }
    if constexpr (Joint::has_linear) origin += ds.linear + cross(w_carried + omega, s.linear);
    w.w[i] = omega;
    w.a[i] = {origin, domega};

    const Vec3<S> f = c.mass * (origin + cross(domega, c.com) + cross(omega, cross(omega, c.com)));
    const Vec3<S> n = c.rotational * domega + cross(omega, c.rotational * omega) + cross(c.com, f);
    w.f[i] = {f, n};
    if (fext) w.f[i] -= fext[i];
  });
}

/// tau = S^T f, and each body's force on its parent.
template <class S, class Order>
void rneaInward(const Order& order, Workspace<S>& w, S* tau) {
  order.backward([&]<class Joint>(const Joint& joint, int i, int iv) {
    order.unite(i, w.f[i]);
    joint.project(w.f[i], tau + iv);
    if (!order.isRoot(i)) order.addToParent(w.f, i, w.rel[i].act(w.f[i]));
  });
}

}  // namespace dyn::kernels
