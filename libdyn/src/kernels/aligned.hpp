// Aligned frames: the axes of the tree's root body (of the world, when the root does not fly) with the origin at each joint.
//
// Inertias are rotated once, shifts from joint to joint are pure translations formed as R_parent * p_local, and no world position
// enters: results stay exact however far the base stands from the origin. A flying root carries its own axes: R = 1 there, and the world's
// directions are turned instead.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// Arrays that parents hand on to their children: `others`, and behind them those of placeAligned.
template <class Order, class S, class... T>
auto passingAxes(const Order&, const Workspace<S>& w, T*... others) {
  if constexpr (Order::waits) {
    return passing(others..., w.R, w.product);
  } else {
    return passing(others..., w.R);
  }
}

/// Writes w.R and w.r of body i, and of a flying root w.rel. axes, products: FromParent of w.R and, for an order that waits, of w.product.
template <class S, class Joint, class Order, class Placement, class Axes, class... Products>
Mat3<S> placeAligned(const Joint& joint, const Order& order, const Placement& placement, int i, Workspace<S>& w, Axes&& axes,
                     Products&&... products) {
  if (isFlyingRoot<Joint>(order, i)) {
    w.rel[i] = placedInParent<S>(joint, cast<S>(placement));
    axes.leave(Mat3<S>::identity());
    (products.leave(Mat3<S>::identity()), ...);
    w.r[i] = {};
    return Mat3<S>::identity();
  }
  const Mat3<S>& parent = axes.get();
  if constexpr (Order::waits) {
    // The joint's axes before it moves: constants are on the right of products, where they need not be in registers.
    auto& parents = (products, ...);
    const Mat3<S> E = placedAxes(parents.get(), placement.R, order.index(i).exchange), product = joint.rotate(E);
    Mat3<S> R = renewed(product);
    Vec3<S> r = parent * placement.p;
    if constexpr (Joint::moves_origin) r += E * joint.translation();
    w.r[i] = r;
    parents.leave(product);
    axes.leave(R);
    return R;
  } else {
    const SE3<S> rel = placedInParent<S>(joint, placement);
    // Generated code pays for every operation: there a few products in a row go by before they are brought back to the rotations.
    bool renew = true;
    if constexpr (is_symbolic<S>) renew = order.depth(i) % 8 == 0;
    Mat3<S> R = renew ? renewed(parent * rel.R) : parent * rel.R;
    w.r[i] = parent * rel.p;
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

/// Symmetric to the last bit.
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
/// Of body i in aligned axes, which are a flying root's own; its axes are in w.R. It waits for nothing else, and takes little time beside what
/// waits for neighbours: sweeps to the root, where inertias are gathered, compute it on the way.
template <class Joint, class S, class Order>
AlignedInertia<S> alignedInertia(const Order& order, const Workspace<S>& w, int i) {
  const auto& c = order.constants(i);
  if (isFlyingRoot<Joint>(order, i)) return {S(c.mass), cast<S>(c.h), cast<S>(c.origin)};
  const Mat3<S>& R = w.R[i];
  return {S(c.mass), R * c.h, congruence(R, c.origin)};
}

/// A force that is given in the axes of body i.
template <class S, class T>
Force<S> inAlignedAxes(const Workspace<S>& w, int i, const Force<T>& f) {
  return {w.R[i] * f.linear, w.R[i] * f.angular};
}

/// What velocities make of a body's acceleration, aligned axes at its joint's origin, r from the parent's: wp is the parent's angular velocity,
/// omega the body's, s the joint's motion.
template <class Joint, class S>
Motion<S> velocityAcceleration(const Joint& joint, const Mat3<S>& R, const Vec3<S>& r, const Vec3<S>& wp, const Vec3<S>& omega, const Motion<S>& s) {
  Motion<S> beta{cross(wp, cross(wp, r)), {}};
  if constexpr (Joint::has_angular) beta.angular = cross(wp, s.angular);
  if constexpr (Joint::has_linear) beta.linear += cross(wp + omega, s.linear);
  if constexpr (Joint::has_bias) {
    const Motion<S> b = joint.bias();
    beta += {R * b.linear, R * b.angular};
  }
  return beta;
}

/// The columns of a joint's motion subspace in aligned axes, into `dof`; of each the parts that its shape has.
template <class S, class Joint>
void writeColumns(const Joint& joint, const Mat3<S>& R, DofFactor<S>* dof) {
  for (int k = 0; k < Joint::nv; ++k) {
    const Motion<S> s = joint.columnIn(R, k);
    if constexpr (Joint::has_linear) dof[k].S_.linear = s.linear;
    if constexpr (Joint::has_angular) dof[k].S_.angular = s.angular;
  }
}

/// One column as writeColumns left it: computes with the parts that the joint's shape has.
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
  /// Of a pack of forces.
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
  /// |linear part|^2 of the one and |angular part|^2 of the other.
  S weighted(const S& linear, const S& angular) const {
    S sum(0);
    if constexpr (Joint::has_linear) sum = dot(s.linear, s.linear) * linear;
    if constexpr (Joint::has_angular) sum += dot(s.angular, s.angular) * angular;
    return sum;
  }
};

/// One of a flying root, whose columns are the unit vectors.
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

/// Calls use(column), where column(k) is the joint's k-th.
template <class Joint, class S, class Order, class Use>
void withColumns(const Order& order, const Workspace<S>& w, int i, int iv, Use&& use) {
  if constexpr (Joint::is_free) {
    if (order.isRoot(i)) return use([](int k) { return UnitColumn<S>{k}; });
  }
  use([&](int k) { return Column<Joint, S>{w.dof[iv + k].S_}; });
}

}  // namespace dyn::kernels
