// The way from a parent's origin to a joint's. Most are along one or two of the parent's axes: each part of its own leaves out what zeros would be
// multiplied with.
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/shapes.hpp"

#include <dyn/spatial/inertia.hpp>

namespace dyn::kernels {

template <class S, int axis>
struct AxisLever {
  static constexpr int x = axis, y = (axis + 1) % 3, z = (axis + 2) % 3;
  S length;

  friend Vec3<S> operator*(const Mat3<S>& A, const AxisLever& r) { return r.length * A.col(x); }
  /// Adds a x r.
  friend void addCross(Vec3<S>& sum, const Vec3<S>& a, const AxisLever& r) {
    sum[y] += a[z] * r.length;
    sum[z] -= a[y] * r.length;
  }
  /// Adds r x b.
  friend void addCross(Vec3<S>& sum, const AxisLever& r, const Vec3<S>& b) {
    sum[y] -= r.length * b[z];
    sum[z] += r.length * b[y];
  }
  /// Adds w x (w x r).
  friend void addCentripetal(Vec3<S>& sum, const Vec3<S>& w, const AxisLever& r) {
    const S u = w[y] * r.length, v = w[z] * r.length;
    sum[x] -= w[y] * u;
    sum[x] -= w[z] * v;
    sum[y] += w[x] * u;
    sum[z] += w[x] * v;
  }
  /// As ArticulatedInertia::shifted.
  friend void shift(ArticulatedInertia<S>& I, Force<S>& f, const AxisLever& r) {
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

/// Calls use(r) for the parts of body i's lever along its parent's axes, AxisLevers each, less those that are always zero. Of orders whose lanes have
/// levers of their own: for the lever, if there is one. origin() is where it leads.
template <class S, class Joint, class Order, class Origin, class Use>
void alongLever(const Order& order, int i, Origin&& origin, Use&& use) {
  if constexpr (!Order::alike) {
    if (order.hasLever(i)) use(origin());
  } else if constexpr (Joint::moves_origin) {
    const Vec3<S> r = origin();
    use(AxisLever<S, 0>{r.x});
    use(AxisLever<S, 1>{r.y});
    use(AxisLever<S, 2>{r.z});
  } else {
    const unsigned axes = order.index(i).lever;
    if (axes & 1) use(AxisLever<S, 0>{origin().x});
    if (axes & 2) use(AxisLever<S, 1>{origin().y});
    if (axes & 4) use(AxisLever<S, 2>{origin().z});
  }
}

}  // namespace dyn::kernels
