// SPDX-License-Identifier: BSD-2-Clause
// Aligned frames have their origin at each joint and the axes of the tree's floating base, or of the world if there is no floating base.
//
// Inertias are rotated once, and shifts from joint to joint are pure translations, formed as R_parent * p_local. No world position enters, so results
// stay exact however far the base is from the world's origin. A floating base keeps its own axes: R = 1 there, and the world's directions are turned
// into these axes instead.
#pragma once

#include "kernels/order/joint_frames.hpp"

namespace dyn::kernels {

/// The arrays that parents pass to their children: `others`, and then those of placeAligned().
template <class Order, class S, class... T>
auto passingAxes(const Order&, const Workspace<S>& w, T*... others) {
  if constexpr (Order::latency_bound) {
    return passing(others..., w.R, w.product);
  } else {
    return passing(others..., w.R);
  }
}

/// Returns of() if body i has a joint offset, and zeros otherwise.
template <class S, class Order, class Of>
Vec3<S> offsetTerm(const Order& order, int i, Of&& of) {
  if (!order.hasOffset(i)) return Vec3<S>{};
  return of();
}

/// How products of rotations are orthonormalised. `whole` uses all columns. It serves where pivots depend on the result, because they have its error
/// many times. `from_columns` uses two columns, at half the cost.
enum class Orthonormalisation { whole, from_columns };

/// The rotation whose first and last columns are nearly these two. They are nearly orthonormal, and are corrected in the way of orthonormalised().
template <class S>
Mat3<S> orthonormalisedFrom(const Vec3<S>& first, const Vec3<S>& last) {
  const S half(0.5);
  const Vec3<S> z = last - (half * (dot(last, last) - S(1))) * last;
  const Vec3<S> x = first - ((half * (dot(first, first) - S(1))) * first + dot(first, last) * last), y = cross(z, x);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
}

/// Writes w.R and w.r of body i, and w.rel of a floating base. axes and products are FromParent of w.R and, in latency-bound orders, of w.product.
template <class S, Orthonormalisation orthonormalisation = Orthonormalisation::whole, class Joint, class Order, class Placement, class Axes,
          class... Products>
Mat3<S> placeAligned(const Joint& joint, const Order& order, const Placement& placement, int i, Workspace<S>& w, Axes&& axes,
                     Products&&... products) {
  if (isFloatingBase<Joint>(order, i)) {
    w.rel[i] = placedInParent<S>(joint, cast<S>(placement));
    axes.leave(Mat3<S>::identity());
    (products.leave(Mat3<S>::identity()), ...);
    w.r[i] = {};
    return Mat3<S>::identity();
  }
  const Mat3<S>& parent = axes.get();
  if constexpr (Order::latency_bound) {
    // E are the joint's axes before it moves. Constants are the right factors of products, where they need not be in registers.
    auto& parents = (products, ...);
    const Mat3<S> E = placedAxes(parents.get(), placement.R, order.index(i).exchange), product = joint.rotate(E);
    Mat3<S> R = orthonormalised(product);
    w.r[i] = offsetTerm<S>(order, i, [&] {
      Vec3<S> r = parent * placement.p;
      if constexpr (Joint::moves_origin) r += E * joint.translation();
      return r;
    });
    parents.leave(product);
    axes.leave(R);
    return R;
  } else if constexpr (orthonormalisation == Orthonormalisation::from_columns && Joint::about_z && Order::lanes_are_states) {
    Vec3<S> x, z;
    withRotation(
        joint, order, i, [&] { return joint.rotate(placement.R); },
        [&](const auto& R) {
          x = firstColumn(parent, R);
          z = lastColumn(parent, R);
        });
    Mat3<S> R = orthonormalisedFrom(x, z);
    Vec3<S> offset{};
    alongOffset<S, Joint>(
        order, i, [&] { return placement.p; }, [&](const auto& r) { offset += parent * r; });
    w.r[i] = offset;
    axes.leave(R);
    return R;
  } else {
    const SE3<S> rel = placedInParent<S>(joint, placement);
    // Generated code pays for every operation, so there products are orthonormalised at every eighth level only.
    bool orthonormalise = true;
    if constexpr (is_symbolic<S>) orthonormalise = order.depth(i) % 8 == 0;
    Mat3<S> R = orthonormalise ? orthonormalised(parent * rel.R) : parent * rel.R;
    w.r[i] = offsetTerm<S>(order, i, [&] { return parent * rel.p; });
    axes.leave(R);
    return R;
  }
}

template <class S>
S trace(const Mat3<S>& K) {
  return K(0, 0) + K(1, 1) + K(2, 2);
}
template <class S>
S trace(const Sym3<S>& a) {
  return a.xx + a.yy + a.zz;
}

/// The full matrix, symmetric to the last bit.
template <class S>
Mat3<S> symmetricMatrix(const Sym3<S>& a) {
  return a.matrix();
}

/// A rigid body's inertia about its origin.
template <class S>
struct AlignedInertia {
  S mass;
  Vec3<S> h;
  Sym3<S> Io;
};
/// The inertia of body i in aligned axes, which at a floating base are its own. It waits for nothing but w.R, and takes little time next to the work
/// that waits for neighbours. Inward sweeps, which gather inertias, therefore compute it on the way.
template <class Joint, class S, class Order>
AlignedInertia<S> alignedInertia(const Order& order, const Workspace<S>& w, int i) {
  return withInertia(order, i, [&](const auto& c) -> AlignedInertia<S> {
    if (isFloatingBase<Joint>(order, i)) return {S(c.mass), cast<S>(c.h), cast<S>(c.origin)};
    const Mat3<S>& R = w.R[i];
    return {S(c.mass), R * c.h, congruence(R, c.origin)};
  });
}

/// Turns a force from the axes of body i into aligned axes.
template <class S, class T>
Force<S> inAlignedAxes(const Workspace<S>& w, int i, const Force<T>& f) {
  return {w.R[i] * f.linear, w.R[i] * f.angular};
}

/// w x r and w x (w x r) in aligned axes. r is the joint offset of body i.
template <class S, class Order>
Vec3<S> offsetRate(const Order& order, int i, const Vec3<S>& w) {
  return offsetTerm<S>(order, i, [&] { return cross(w, order.w.r[i]); });
}
template <class S, class Order>
Vec3<S> offsetAcceleration(const Order& order, int i, const Vec3<S>& w) {
  return offsetTerm<S>(order, i, [&] { return cross(w, cross(w, order.w.r[i])); });
}
/// The acceleration of body i due to velocities, in aligned axes at its joint's origin. wp is the parent's angular velocity, omega the body's, and s
/// the joint's motion.
template <class Joint, class Order, class S>
Motion<S> velocityAcceleration(const Joint& joint, const Order& order, int i, const Mat3<S>& R, const Vec3<S>& wp, const Vec3<S>& omega,
                               const Motion<S>& s) {
  Motion<S> beta{offsetAcceleration(order, i, wp), {}};
  if constexpr (Joint::has_angular) beta.angular = cross(wp, s.angular);
  if constexpr (Joint::has_linear) beta.linear += cross(wp + omega, s.linear);
  if constexpr (Joint::has_bias) {
    const Motion<S> b = joint.bias();
    beta += {R * b.linear, R * b.angular};
  }
  return beta;
}

/// Writes the columns of a joint's motion subspace to `dof`, in aligned axes. It writes only the parts that the joint's shape has.
template <class S, class Joint>
void writeColumns(const Joint& joint, const Mat3<S>& R, DofFactor<S>* dof) {
  for (int k = 0; k < nvOf(joint); ++k) {
    const Motion<S> s = joint.columnIn(R, k);
    if constexpr (Joint::has_linear) dof[k].column.linear = s.linear;
    if constexpr (Joint::has_angular) dof[k].column.angular = s.angular;
  }
}

/// One column as writeColumns() left it. It computes only with the parts that the joint's shape has.
template <class Joint, class S>
struct Column {
  const Motion<S>& s;

  Force<S> force(const ArticulatedInertia<S>& I) const {
    if constexpr (!Joint::has_linear) {
      return {I.coupling * s.angular, I.angular * s.angular};
    } else if constexpr (!Joint::has_angular) {
      return {I.linear * s.linear, transposeTimes(I.coupling, s.linear)};
    } else {
      return I * s;
    }
  }
  S along(const Force<S>& f) const {
    if constexpr (!Joint::has_linear) {
      return dot(s.angular, f.angular);
    } else if constexpr (!Joint::has_angular) {
      return dot(s.linear, f.linear);
    } else {
      return dot(s, f);
    }
  }
  /// The same for a scalar F that holds numbers of several forces at once.
  template <class F>
  F along(const Force<F>& f) const {
    if constexpr (!Joint::has_linear) {
      return dot(cast<F>(s.angular), f.angular);
    } else if constexpr (!Joint::has_angular) {
      return dot(cast<F>(s.linear), f.linear);
    } else {
      return dot(cast<F>(s.linear), f.linear) + dot(cast<F>(s.angular), f.angular);
    }
  }
  void addTo(Motion<S>& a, const S& x) const {
    if constexpr (Joint::has_linear) a.linear += x * s.linear;
    if constexpr (Joint::has_angular) a.angular += x * s.angular;
  }
  /// linear^T s.linear + angular^T s.angular.
  Vec3<S> along(const Mat3<S>& linear, const Mat3<S>& angular) const {
    Vec3<S> sum{};
    if constexpr (Joint::has_linear) sum += transposeTimes(linear, s.linear);
    if constexpr (Joint::has_angular) sum += transposeTimes(angular, s.angular);
    return sum;
  }
  /// |s.linear|^2 linear + |s.angular|^2 angular.
  S weighted(const S& linear, const S& angular) const {
    S sum(0);
    if constexpr (Joint::has_linear) sum = dot(s.linear, s.linear) * linear;
    if constexpr (Joint::has_angular) sum += dot(s.angular, s.angular) * angular;
    return sum;
  }
};

/// A column of a floating base, which is a unit vector.
template <class S>
struct UnitColumn {
  int k;

  Force<S> force(const ArticulatedInertia<S>& I) const {
    if (k >= 3) return {I.coupling.col(k - 3), I.angular.matrix().col(k - 3)};
    return {I.linear.matrix().col(k), I.coupling.row(k)};
  }
  template <class F>
  F along(const Force<F>& f) const {
    return k < 3 ? f.linear[k] : f.angular[k - 3];
  }
  void addTo(Motion<S>& a, const S& x) const { addAt(k < 3 ? a.linear : a.angular, k % 3, x); }
  Vec3<S> along(const Mat3<S>& linear, const Mat3<S>& angular) const { return k < 3 ? linear.row(k) : angular.row(k - 3); }
  S weighted(const S& linear, const S& angular) const { return k < 3 ? linear : angular; }
};

/// Calls use(column), where column(k) is the joint's k-th column.
template <class Joint, class S, class Order, class Use>
void withColumns(const Order& order, const Workspace<S>& w, int i, int iv, Use&& use) {
  if constexpr (Joint::is_free) {
    if (order.isRoot(i)) return use([](int k) { return UnitColumn<S>{k}; });
  }
  use([&](int k) { return Column<Joint, S>{w.dof[iv + k].column}; });
}

}  // namespace dyn::kernels
