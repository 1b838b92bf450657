// Exponential, logarithm and Jacobians of SE(3), tangent vectors linear part first.
#pragma once

#include <dyn/lie/so3.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

/// 6x6 Jacobian of SE(3): [[diagonal, upper], [0, diagonal]].
template <class S>
struct Jacobian6 {
  Mat3<S> diagonal, upper;
};

/// exp of a twist held for unit time: R = exp(w), p = V(w) v with V the left Jacobian.
template <class S>
SE3<S> exp6(const Motion<S>& m) {
  return {exp3(m.angular), transposeTimes(Jexp3(m.angular), m.linear)};
}

/// log of a transform whose rotation vector is known.
template <class S>
Motion<S> log6(const Vec3<S>& rotation, const Vec3<S>& p) {
  return {transposeTimes(Jlog3(rotation), p), rotation};
}
template <class S>
Motion<S> log6(const SE3<S>& X) {
  return log6(log3(X.R), X.p);
}

/// Right Jacobian of exp6 (Barfoot 2017, eq. 7.86, with the signs of both arguments turned).
template <class S>
Jacobian6<S> Jexp6(const Motion<S>& m) {
  const RotationCoefficients<S> k(dot(m.angular, m.angular));
  const Mat3<S> P = skew(-m.linear), W = skew(-m.angular);
  const Mat3<S> WP = W * P, PW = P * W, WPW = W * PW;
  const S e = S(0.5) * (k.d - S(3) * k.e);
  const Mat3<S> Q = S(0.5) * P + k.c * (WP + PW + WPW) + k.d * (W * WP + PW * W - S(3) * WPW) + e * (WPW * W + W * WPW);
  return {Jexp3(m.angular), Q};
}

/// Inverse of Jexp6 at m = log6(X).
template <class S>
Jacobian6<S> Jlog6(const Motion<S>& m) {
  const Mat3<S> D = Jlog3(m.angular);
  return {D, S(-1) * (D * Jexp6(m).upper * D)};
}

/// Matrix of the action on motions, in the same block form: [[R, [p]R], [0, R]].
template <class S>
Jacobian6<S> actionMatrix(const SE3<S>& X) {
  return {X.R, skew(X.p) * X.R};
}
template <class S>
Jacobian6<S> operator*(const Jacobian6<S>& a, const Jacobian6<S>& b) {
  return {a.diagonal * b.diagonal, a.diagonal * b.upper + a.upper * b.diagonal};
}

}  // namespace dyn
