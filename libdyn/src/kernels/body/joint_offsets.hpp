// SPDX-License-Identifier: BSD-2-Clause
// Joint offsets, from the parent's origin to the joint's origin. Most offsets lie along one or two of the parent's axes. They are processed axis by
// axis, which saves products with zeros.
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/body/shapes.hpp"

#include <dyn/spatial/inertia.hpp>

namespace dyn::kernels {

template <class S, int axis>
struct AxisOffset {
  static constexpr int x = axis, y = (axis + 1) % 3, z = (axis + 2) % 3;
  S length;

  friend Vec3<S> operator*(const Mat3<S>& A, const AxisOffset& r) { return r.length * A.col(x); }
  /// Adds a x r.
  friend void addCross(Vec3<S>& sum, const Vec3<S>& a, const AxisOffset& r) {
    sum[y] += a[z] * r.length;
    sum[z] -= a[y] * r.length;
  }
  /// Adds r x b.
  friend void addCross(Vec3<S>& sum, const AxisOffset& r, const Vec3<S>& b) {
    sum[y] -= r.length * b[z];
    sum[z] += r.length * b[y];
  }
  /// Adds w x (w x r).
  friend void addCentripetal(Vec3<S>& sum, const Vec3<S>& w, const AxisOffset& r) {
    const S u = w[y] * r.length, v = w[z] * r.length;
    sum[x] -= w[y] * u;
    sum[x] -= w[z] * v;
    sum[y] += w[x] * u;
    sum[z] += w[x] * v;
  }
  /// Shifts I like ArticulatedInertia::shifted, and f with it.
  friend void shift(ArticulatedInertia<S>& I, Force<S>& f, const AxisOffset& r) {
    const Mat3<S> L = I.linear.matrix(), C = I.coupling;
    for (int i = 0; i < 3; ++i) {
      I.coupling(i, y) -= L(i, z) * r.length;
      I.coupling(i, z) += L(i, y) * r.length;
    }
    entry(I.angular, x, y) -= r.length * C(z, x);
    entry(I.angular, x, z) += r.length * C(y, x);
    entry(I.angular, y, y) -= r.length * C(z, y);
    entry(I.angular, y, z) += r.length * C(y, y);
    entry(I.angular, z, z) += r.length * C(y, z);
    entry(I.angular, y, y) -= r.length * I.coupling(z, y);
    entry(I.angular, y, z) -= r.length * I.coupling(z, z);
    entry(I.angular, z, z) += r.length * I.coupling(y, z);
    addCross(f.angular, r, f.linear);
  }

 private:
  static S& entry(Sym3<S>& a, int i, int j) {
    if (i == j) return i == 0 ? a.xx : i == 1 ? a.yy : a.zz;
    return i + j == 1 ? a.xy : i + j == 2 ? a.xz : a.yz;
  }
};

/// Calls use(r) for each part of body i's joint offset along its parent's axes, as an AxisOffset; parts that are always zero are left out. In orders
/// whose lanes have different offsets it calls use(r) once with the whole offset, if there is one. origin() returns the offset.
template <class S, class Joint, class Order, class Origin, class Use>
void alongOffset(const Order& order, int i, Origin&& origin, Use&& use) {
  if constexpr (!Order::shared_constants) {
    if (order.hasOffset(i)) use(origin());
  } else if constexpr (Joint::moves_origin) {
    const Vec3<S> r = origin();
    use(AxisOffset<S, 0>{r.x});
    use(AxisOffset<S, 1>{r.y});
    use(AxisOffset<S, 2>{r.z});
  } else {
    const unsigned axes = order.index(i).offset_axes;
    if (axes & 1) use(AxisOffset<S, 0>{origin().x});
    if (axes & 2) use(AxisOffset<S, 1>{origin().y});
    if (axes & 4) use(AxisOffset<S, 2>{origin().z});
  }
}

}  // namespace dyn::kernels
