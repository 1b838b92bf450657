// SPDX-License-Identifier: BSD-2-Clause
// Exponential, logarithm and Jacobians of SE(3). Tangent vectors have their linear part first.
#pragma once

#include <dyn/lie/so3.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

/// 6 x 6 Jacobian of SE(3), [[diagonal, upper], [0, diagonal]].
template <class S>
struct Jacobian6 {
  Mat3<S> diagonal,  ///< both blocks on the diagonal
      upper;         ///< upper right block
};

/// Returns the exponential of a twist (v, w) [m, rad], held for unit time: R = exp(w), p = V(w) v with V the left Jacobian of SO(3).
template <class S>
SE3<S> exp6(const Motion<S>& m) {
  return {exp3(m.angular), transposeTimes(Jexp3(m.angular), m.linear)};
}

/// Returns the logarithm of a transform, a twist [m, rad]. The first form takes a rotation vector [rad] that is already known.
/// @{
template <class S>
Motion<S> log6(const Vec3<S>& rotation, const Vec3<S>& p) {
  return {transposeTimes(Jlog3(rotation), p), rotation};
}
template <class S>
Motion<S> log6(const SE3<S>& X) {
  return log6(log3(X.R), X.p);
}
/// @}

/// Returns the right Jacobian of exp6 (Barfoot 2017, eq. 7.86, with the signs of both arguments changed). Barfoot's products of up to four
/// matrices are expanded with s = v . w. This removes the high powers of the angle, and with them the cancellation at large angles:
/// Q = -b [v] + c (v w' + w v') + s ((c - b) 1 - f [w] - g w w') is the upper block.
template <class S>
Jacobian6<S> Jexp6(const Motion<S>& m) {
  const Vec3<S>&v = m.linear, &w = m.angular;
  const RotationCoefficients<S> k = rotationCoefficients(w);
  const S s = dot(v, w);
  Mat3<S> Q = skew(-k.b * v - (s * k.f) * w);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) Q(i, j) += k.c * (v[i] * w[j] + w[i] * v[j]) - (s * k.g) * (w[i] * w[j]);
    Q(i, i) += s * (k.c - k.b);
  }
  return {Jexp3(w), Q};
}

/// Returns the inverse of Jexp6 at m = log6(X). D is Jlog3 at m's angular part; the second form computes it.
/// @{
template <class S>
Jacobian6<S> Jlog6(const Motion<S>& m, const Mat3<S>& D) {
  return {D, S(-1) * (D * Jexp6(m).upper * D)};
}
template <class S>
Jacobian6<S> Jlog6(const Motion<S>& m) {
  return Jlog6(m, Jlog3(m.angular));
}
/// @}

/// Returns Jlog6 at -m from Jlog6 at m: both blocks are transposed.
template <class S>
Jacobian6<S> opposite(const Jacobian6<S>& Jlog) {
  return {transpose(Jlog.diagonal), transpose(Jlog.upper)};
}

/// Returns the matrix of the action on motions, in the same block form: [[R, [p]R], [0, R]].
template <class S>
Jacobian6<S> actionMatrix(const SE3<S>& X) {
  return {X.R, skew(X.p) * X.R};
}
/// Returns the matrix product, which has the same block form.
template <class S>
Jacobian6<S> operator*(const Jacobian6<S>& a, const Jacobian6<S>& b) {
  return {a.diagonal * b.diagonal, a.diagonal * b.upper + a.upper * b.diagonal};
}

}  // namespace dyn
