// SPDX-License-Identifier: BSD-2-Clause
// Elimination of joints about z, in the bodies' own axes.
#pragma once

#include "kernels/order/joint_frames.hpp"
#include "kernels/recursion/aba.hpp"

namespace dyn::kernels {

/// Projects out rotation about z from the articulated inertia of body i, whose joint has no armature. The remaining inertia has zero rows and columns
/// there. Each part of an inertia is read where it is needed, and its result is written before the next part is read, because all parts together do
/// not fit into the registers.
template <class S, class Order>
class RevoluteElimination {
 public:
  /// given and given_force are the sums of the children's articulated inertias and bias forces. tau is the joint's torque.
  RevoluteElimination(const Order& order, int i, int iv, const S& tau, const ArticulatedInertia<S>& given, const Force<S>& given_force)
      : order_(order),
        constants_(order.numberConstants(i)),
        omega_(order.w.w[i]),
        beta_(order.w.beta[i]),
        tau_(tau),
        given_(given),
        given_force_(given_force),
        dof_(order.w.dof[iv]),
        i_(i) {}

  /// Writes the degree of freedom's factor, and w.failed as abaInward() does.
  void eliminate() {
    const Sym3<S> own = this->origin();
    bias_ = cross(omega_, own * omega_) + given_force_.angular;
    const Vec3<S> h = this->h();
    const Sym3<S>& angular = given_.angular;
    Vec3<S> a = given_.coupling.col(2);
    a.x -= h.y;
    a.y += h.x;
    const S pivot = angular.zz + own.zz;
    dof_.W = {a, {angular.xz + own.xz, angular.yz + own.yz, pivot}};
    noteVanishing(pivot, angular.xx + own.xx + angular.yy + own.yy + pivot, i_, order_.w.failed);
    dof_.inverse = S(1) / pivot;
    dof_.y = (tau_ - bias_.z) / pivot;
  }

  /// Writes the remaining inertia to `left`, in the axes that R leads to. Returns the bias force that belongs to it.
  template <class Rotation>
  Force<S> leave(const Rotation& R, ArticulatedInertia<S>& left) const {
    Force<S> f{cross(omega_, cross(omega_, this->h())) + given_force_.linear, bias_};
    {
      const S mass = this->mass();
      const DofFactor<S>& dof = readAgain(order_, dof_);
      const Vec3<S>&a = dof.W.linear, scaled = dof.inverse * a;
      const Sym3<S>& all = given_.linear;
      const Sym3<S> part{all.xx + mass - a.x * scaled.x, all.xy - a.x * scaled.y, all.xz - a.x * scaled.z,
                         all.yy + mass - a.y * scaled.y, all.yz - a.y * scaled.z, all.zz + mass - a.z * scaled.z};
      f.linear += dof.y * a;
      f.linear += part * beta_.linear;
      left.linear = congruence(R, part);
    }
    {
      const Vec3<S> h = this->h();
      const DofFactor<S>& dof = readAgain(order_, dof_);
      const Vec3<S>& a = dof.W.linear;
      const S x = dof.inverse * dof.W.angular.x, y = dof.inverse * dof.W.angular.y;
      Vec3<S> by_x = given_.coupling.col(0), by_y = given_.coupling.col(1);
      by_x = {by_x.x, by_x.y - h.z, by_x.z + h.y};
      by_y = {by_y.x + h.z, by_y.y, by_y.z - h.x};
      by_x -= x * a;
      by_y -= y * a;
      f.linear += beta_.angular.x * by_x + beta_.angular.y * by_y;
      f.angular.x += dot(by_x, beta_.linear);
      f.angular.y += dot(by_y, beta_.linear);
      left.coupling = planarCongruence(R, by_x, by_y);
    }
    {
      const Sym3<S> own = this->origin();
      const DofFactor<S>& dof = readAgain(order_, dof_);
      const S &u = dof.W.angular.x, &v = dof.W.angular.y, x = dof.inverse * u, y = dof.inverse * v;
      const Sym3<S>& all = given_.angular;
      const S xx = all.xx + own.xx - u * x, xy = all.xy + own.xy - u * y, yy = all.yy + own.yy - v * y;
      f.angular = {f.angular.x + dof.y * u + xx * beta_.angular.x + xy * beta_.angular.y,
                   f.angular.y + dof.y * v + xy * beta_.angular.x + yy * beta_.angular.y, tau_};
      left.angular = planarCongruence(R, xx, xy, yy);
    }
    return {R * f.linear, R * f.angular};
  }

 private:
  /// part(c) of the body's constants c.
  template <class Part>
  auto constant(Part&& part) const {
    if constexpr (requires { order_.ownInertia(i_); })
      if (const auto* own = order_.ownInertia(i_)) [[unlikely]]
        return part(readAgain(order_, *own));
    return part(broadcast<S>(readAgain(order_, constants_)));
  }
  S mass() const {
    return constant([](const auto& c) { return c.mass; });
  }
  Vec3<S> h() const {
    return constant([](const auto& c) { return c.h; });
  }
  Sym3<S> origin() const {
    return constant([](const auto& c) { return c.origin; });
  }

  const Order& order_;
  const BodyConstants<Real<S>>& constants_;
  const Vec3<S>& omega_;
  const Motion<S>& beta_;
  const S& tau_;
  const ArticulatedInertia<S>& given_;
  const Force<S>& given_force_;
  DofFactor<S>& dof_;
  Vec3<S> bias_;
  int i_;
};

}  // namespace dyn::kernels
