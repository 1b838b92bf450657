// SPDX-License-Identifier: BSD-2-Clause
// Rigid-body inertia and articulated-body inertia.
#pragma once

#include <dyn/spatial/se3.hpp>

namespace dyn {

/// Inertia of a rigid body, given in the body's frame; zero by default.
template <class S>
struct Inertia {
  S mass{};              ///< mass [kg]
  Vec3<S> com{};         ///< centre of mass [m]
  Sym3<S> rotational{};  ///< rotational inertia about the centre of mass [kg m^2]

  /// Returns the momentum of the body that moves with v. Both are at the frame's origin.
  friend Force<S> operator*(const Inertia& Y, const Motion<S>& v) {
    const Vec3<S> l = Y.mass * (v.linear + cross(v.angular, Y.com));
    return {l, Y.rotational * v.angular + cross(Y.com, l)};
  }
  /// Returns the inertia of two bodies welded together, both given in the same frame. The centre of mass is zero if the masses add up to zero.
  friend Inertia operator+(const Inertia& a, const Inertia& b) {
    const S m = a.mass + b.mass;
    if (!(m > S(0)) && !(m < S(0))) return {m, {}, a.rotational + b.rotational};
    const S wa = a.mass / m, wb = b.mass / m;
    return {m, wa * a.com + wb * b.com, a.rotational + b.rotational + (a.mass * wb) * pointInertia(a.com - b.com)};
  }
  /// Returns the same inertia in frame a, where aMb is the pose of this inertia's frame b.
  Inertia transformed(const SE3<S>& aMb) const { return {mass, aMb.act(com), congruence(aMb.R, rotational)}; }
  /// Returns the rotational inertia about the frame's origin [kg m^2].
  Sym3<S> rotationalAtOrigin() const { return rotational + mass * pointInertia(com); }
};

/// Returns the same inertia in another scalar.
template <class To, class From>
Inertia<To> cast(const Inertia<From>& Y) {
  return {static_cast<To>(Y.mass), cast<To>(Y.com), cast<To>(Y.rotational)};
}

/// Symmetric 6 x 6 inertia [[linear, coupling], [coupling^T, angular]], zero by default. It maps an acceleration to a force, both at the same origin
/// (Featherstone 2008, ch. 7).
template <class S>
struct ArticulatedInertia {
  Sym3<S> linear{};    ///< maps linear acceleration to force [kg]
  Mat3<S> coupling{};  ///< maps angular acceleration to force [kg m]
  Sym3<S> angular{};   ///< maps angular acceleration to moment [kg m^2]

  /// Returns the inertia of a rigid body with first moment h = m c [kg m] and this rotational inertia about the origin [kg m^2].
  static ArticulatedInertia rigid(const S& mass, const Vec3<S>& h, const Sym3<S>& angularAtOrigin) {
    return {{mass, S(0), S(0), mass, S(0), mass}, {{S(0), h.z, -h.y, -h.z, S(0), h.x, h.y, -h.x, S(0)}}, angularAtOrigin};
  }

  /// Returns the force for an acceleration.
  friend Force<S> operator*(const ArticulatedInertia& Y, const Motion<S>& a) {
    return {Y.linear * a.linear + Y.coupling * a.angular, transposeTimes(Y.coupling, a.linear) + Y.angular * a.angular};
  }
  /// Adds entry by entry. Both inertias are in the same frame.
  /// @{
  friend ArticulatedInertia operator+(const ArticulatedInertia& a, const ArticulatedInertia& b) {
    return {a.linear + b.linear, a.coupling + b.coupling, a.angular + b.angular};
  }
  ArticulatedInertia& operator+=(const ArticulatedInertia& b) { return *this = *this + b; }
  /// @}

  /// Subtracts factor W W^T, one term of a projection.
  void subtractSquare(const Force<S>& W, const S& factor) {
    const Force<S> row = factor * W;
    const Vec3<S>&a = W.linear, &b = W.angular, &c = row.linear, &d = row.angular;
    linear = linear - Sym3<S>{a.x * c.x, a.x * c.y, a.x * c.z, a.y * c.y, a.y * c.z, a.z * c.z};
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) coupling(i, j) = coupling(i, j) - a[i] * d[j];
    angular = angular - Sym3<S>{b.x * d.x, b.x * d.y, b.x * d.z, b.y * d.y, b.y * d.z, b.z * d.z};
  }

  /// Returns the same inertia about another origin, with unchanged axes: r is the vector from the new origin to the old one.
  /// With X the skew matrix of r: coupling' = coupling - linear X, angular' = angular + X coupling + (X coupling)^T - X linear X.
  ArticulatedInertia shifted(const Vec3<S>& r) const {
    ArticulatedInertia out;
    out.linear = linear;
    const Mat3<S> L = linear.matrix();
    for (int i = 0; i < 3; ++i) {
      // Row i of linear X is (row i of linear) x r, since l^T [r] = (l x r)^T.
      const Vec3<S> l = cross(L.row(i), r);
      out.coupling(i, 0) = coupling(i, 0) - l.x;
      out.coupling(i, 1) = coupling(i, 1) - l.y;
      out.coupling(i, 2) = coupling(i, 2) - l.z;
    }
    // X coupling + (X coupling)^T - X linear X = X coupling' + (X coupling)^T.
    Mat3<S> A;
    for (int j = 0; j < 3; ++j) {
      const Vec3<S> a = cross(r, out.coupling.col(j));
      A(0, j) = a.x;
      A(1, j) = a.y;
      A(2, j) = a.z;
    }
    Mat3<S> B;
    for (int j = 0; j < 3; ++j) {
      const Vec3<S> b = cross(r, coupling.col(j));
      B(j, 0) = b.x;
      B(j, 1) = b.y;
      B(j, 2) = b.z;
    }
    out.angular = angular + Sym3<S>{A(0, 0) + B(0, 0), A(0, 1) + B(0, 1), A(0, 2) + B(0, 2), A(1, 1) + B(1, 1), A(1, 2) + B(1, 2), A(2, 2) + B(2, 2)};
    return out;
  }
};

}  // namespace dyn
