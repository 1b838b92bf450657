// Aligned frames: the axes of the tree's root body (of the world, when the root does not fly) with the origin at each joint.
//
// Inertias are rotated once, shifts from joint to joint are pure translations formed as R_parent * p_local, and no world position
// enters: results stay exact however far the base stands from the origin. A flying root carries its own axes: R = 1 there, and the world's
// directions are turned instead.
#pragma once

#include "kernels/joint_frames.hpp"

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

/// What of() says where body i's origin is elsewhere than its parent's, or zeros.
template <class S, class Order, class Of>
Vec3<S> ofLever(const Order& order, int i, Of&& of) {
  if (!order.hasLever(i)) return Vec3<S>{};
  return of();
}

/// What axes are brought back to rotations from: all their columns, where directions are eliminated and pivots have errors many times; or, of packs
/// of states, two of them, which takes half as much.
enum class Renewal { whole, from_columns };

/// The rotation of two columns that are nearly unit vectors at right angles, in the same way as renewed().
template <class S>
Mat3<S> renewedFrom(const Vec3<S>& first, const Vec3<S>& last) {
  const S half(0.5);
  const Vec3<S> z = last - (half * (dot(last, last) - S(1))) * last;
  const Vec3<S> x = first - ((half * (dot(first, first) - S(1))) * first + dot(first, last) * last), y = cross(z, x);
  return {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
}

/// Writes w.R and w.r of body i, and of a flying root w.rel. axes, products: FromParent of w.R and, for an order that waits, of w.product.
template <class S, Renewal renewal = Renewal::whole, class Joint, class Order, class Placement, class Axes, class... Products>
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
    w.r[i] = ofLever<S>(order, i, [&] {
      Vec3<S> r = parent * placement.p;
      if constexpr (Joint::moves_origin) r += E * joint.translation();
      return r;
    });
    parents.leave(product);
    axes.leave(R);
    return R;
  } else if constexpr (renewal == Renewal::from_columns && Joint::about_z && Order::alike && lanes_of<S> > 1) {
    Vec3<S> x, z;
    withRotation(
        joint, order, i, [&] { return joint.rotate(placement.R); },
        [&](const auto& R) {
          x = firstColumn(parent, R);
          z = lastColumn(parent, R);
        });
    Mat3<S> R = renewedFrom(x, z);
    Vec3<S> lever{};
    alongLever<S, Joint>(
        order, i, [&] { return placement.p; }, [&](const auto& r) { lever += parent * r; });
    w.r[i] = lever;
    axes.leave(R);
    return R;
  } else {
    const SE3<S> rel = placedInParent<S>(joint, placement);
    // Generated code pays for every operation: there a few products in a row go by before they are brought back to the rotations.
    bool renew = true;
    if constexpr (is_symbolic<S>) renew = order.depth(i) % 8 == 0;
    Mat3<S> R = renew ? renewed(parent * rel.R) : parent * rel.R;
    w.r[i] = ofLever<S>(order, i, [&] { return parent * rel.p; });
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

/// Aligned axes: w x r and w x (w x r), r from the parent's origin to body i's.
template <class S, class Order>
Vec3<S> leverRate(const Order& order, int i, const Vec3<S>& w) {
  return ofLever<S>(order, i, [&] { return cross(w, order.w.r[i]); });
}
template <class S, class Order>
Vec3<S> leverAcceleration(const Order& order, int i, const Vec3<S>& w) {
  return ofLever<S>(order, i, [&] { return cross(w, cross(w, order.w.r[i])); });
}
/// What velocities make of body i's acceleration, aligned axes at its joint's origin: wp is the parent's angular velocity, omega the body's, s the
/// joint's motion.
template <class Joint, class Order, class S>
Motion<S> velocityAcceleration(const Joint& joint, const Order& order, int i, const Mat3<S>& R, const Vec3<S>& wp, const Vec3<S>& omega,
                               const Motion<S>& s) {
  Motion<S> beta{leverAcceleration(order, i, wp), {}};
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
  for (int k = 0; k < nvOf(joint); ++k) {
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
