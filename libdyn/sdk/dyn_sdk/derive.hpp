// SPDX-License-Identifier: BSD-2-Clause
// Derives the motion subspace and its bias from the pose map alone, by forward-mode differentiation.
//
// For the pose (R, p) along q(t), S v = (R^T p', vee(R^T R')) in the moving frame. Its derivative at constant v is
// (R^T p'' + R'^T p', vee(R^T R'')): R'^T R' is symmetric and drops out of vee.
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn::sdk {

/// A pose map's result, or its first or second derivative, by columns. It copies only the numbers that are needed, since poses of dual numbers of
/// packs take kilobytes.
template <class S>
struct PosePart {
  /// Columns of the rotation part, and the position.
  /// @{
  Vec3<S> x, y, z, p;
  /// @}

  /// Copies from a pose of duals. part(x) selects one of the numbers of which the dual number x consists.
  template <class D, class Part>
  PosePart(const SE3<D>& X, Part part) : x(column(X.R, 0, part)), y(column(X.R, 1, part)), z(column(X.R, 2, part)) {
    p = {part(X.p.x), part(X.p.y), part(X.p.z)};
  }
  /// Returns the part as a pose.
  SE3<S> pose() const { return {{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}}, p}; }
  /// Returns R^T a.
  Vec3<S> inAxes(const Vec3<S>& a) const { return {dot(x, a), dot(y, a), dot(z, a)}; }
  /// Returns vee(R^T D), where D is the other's rotation part.
  Vec3<S> turning(const PosePart& D) const {
    return {S(0.5) * (dot(z, D.y) - dot(y, D.z)), S(0.5) * (dot(x, D.z) - dot(z, D.x)), S(0.5) * (dot(y, D.x) - dot(x, D.y))};
  }

 private:
  template <class D, class Part>
  static Vec3<S> column(const Mat3<D>& R, int k, Part part) {
    return {part(R.m[k]), part(R.m[3 + k]), part(R.m[6 + k])};
  }
};

/// Returns the velocity in the moving frame when the N coordinates change at the rates dq. `pose` maps N scalars of any type to an SE3 of that type.
template <int N, class S, class Pose>
Motion<S> poseVelocity(const Pose& pose, const S* q, const S* dq) {
  using D = Dual<S>;
  D qd[N];
  for (int i = 0; i < N; ++i) qd[i] = D(q[i], dq[i]);
  const SE3<D> X = pose(qd);
  const PosePart<S> X0(X, [](const D& a) { return a.v; }), X1(X, [](const D& a) { return a.d; });
  return {X0.inAxes(X1.p), X0.turning(X1)};
}

/// Pose, velocity and the velocity's derivative along q(t), in the moving frame.
template <class S>
struct PoseRates {
  SE3<S> pose;         ///< the moving frame's pose
  Motion<S> velocity,  ///< its velocity
      bias;            ///< the velocity's derivative
};
/// Returns pose, velocity and the velocity's derivative where the N coordinates change at the rates dq, and these at the rates ddq. `pose` is as for
/// poseVelocity.
template <int N, class S, class Pose>
PoseRates<S> poseRates(const Pose& pose, const S* q, const S* dq, const S* ddq) {
  using D = Dual<S>;
  using DD = Dual<D>;
  DD qd[N];
  for (int i = 0; i < N; ++i) qd[i] = DD(D(q[i], dq[i]), D(dq[i], ddq[i]));
  const SE3<DD> X = pose(qd);
  const PosePart<S> X0(X, [](const DD& a) { return a.v.v; }), X1(X, [](const DD& a) { return a.v.d; }), X2(X, [](const DD& a) { return a.d.d; });
  return {X0.pose(), {X0.inAxes(X1.p), X0.turning(X1)}, {X0.inAxes(X2.p) + X1.inAxes(X1.p), X0.turning(X2)}};
}

}  // namespace dyn::sdk
