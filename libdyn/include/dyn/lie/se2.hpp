// SPDX-License-Identifier: BSD-2-Clause
// SO(2) and SE(2). Configurations are (cos, sin) and (x, y, cos, sin); tangent vectors are w and (vx, vy, w), in the moving frame.
#pragma once

#include <dyn/lie/so3.hpp>

namespace dyn {

/// Rotation in the plane, the unit rotation by default.
template <class S>
struct SO2 {
  S c{1},   ///< cosine of the angle
      s{};  ///< sine of the angle

  /// Returns the rotation by an angle [rad].
  static SO2 exp(const S& t) {
    using std::cos, std::sin;
    return {cos(t), sin(t)};
  }
  /// Returns the angle [rad] between -pi and pi.
  S log() const {
    using std::atan2;
    return atan2(s, c);
  }
  /// Returns the opposite rotation.
  SO2 inverse() const { return {c, -s}; }
  /// Returns the composition, whose angle is the sum of both.
  friend SO2 operator*(const SO2& a, const SO2& b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }
  /// Divides by the norm, without overflow or underflow. Two zeros give NaN.
  SO2 normalized() const {
    using std::abs, std::sqrt;
    const S m = select(abs(c) > abs(s), S(abs(c)), S(abs(s)));
    const S x = c / m, y = s / m, n = sqrt(x * x + y * y);
    return {x / n, y / n};
  }
};

/// Pose in the plane, the unit transform by default.
template <class S>
struct SE2 {
  S x{},     ///< position along x [m]
      y{};   ///< position along y [m]
  SO2<S> r;  ///< rotation

  /// Returns the composition aMc = aMb bMc.
  friend SE2 operator*(const SE2& a, const SE2& b) { return {a.x + a.r.c * b.x - a.r.s * b.y, a.y + a.r.s * b.x + a.r.c * b.y, a.r * b.r}; }
  /// Returns the inverse transform.
  SE2 inverse() const { return {-(r.c * x + r.s * y), r.s * x - r.c * y, r.inverse()}; }

  /// Returns the exponential of (vx, vy, w) [m, m, rad]: the angle is w, the position p = V(w) (vx, vy) with V = [[a, -b w], [b w, a]].
  static SE2 exp(const Vec3<S>& v) {
    const RotationCoefficients<S> k = rotationCoefficients(Vec3<S>{S(0), S(0), v.z});
    const S bw = k.b * v.z;
    return {k.a * v.x - bw * v.y, bw * v.x + k.a * v.y, SO2<S>::exp(v.z)};
  }
  /// Returns the tangent vector (vx, vy, w) [m, m, rad] of which this is the exponential, with w between -pi and pi.
  Vec3<S> log() const {
    const S w = r.log(), w2 = w * w;
    const S d = S(1) - inverseCoefficient(w2) * w2, h = S(0.5) * w;  // V^-1 = [[d, h], [-h, d]]
    return {d * x + h * y, d * y - h * x, w};
  }
  /// Returns the 3 x 3 matrix of the action on tangent vectors (the adjoint).
  Mat3<S> action() const { return {{r.c, -r.s, y, r.s, r.c, -x, S(0), S(0), S(1)}}; }
};

/// Returns the 3 x 3 right Jacobian of SE2::exp at v (Jexp2), or its inverse (Jlog2), which is unbounded where |w| is 2 pi.
/// @{
template <class S>
Mat3<S> Jexp2(const Vec3<S>& v) {
  const RotationCoefficients<S> k = rotationCoefficients(Vec3<S>{S(0), S(0), v.z});
  const S bw = k.b * v.z, cw = k.c * v.z;
  return {{k.a, bw, cw * v.x - k.b * v.y, -bw, k.a, k.b * v.x + cw * v.y, S(0), S(0), S(1)}};
}
template <class S>
Mat3<S> Jlog2(const Vec3<S>& v) {
  // Inverse of [[A, u], [0, 1]] with A = [[a, bw], [-bw, a]], A^-1 = [[d, -h], [h, d]].
  const S w2 = v.z * v.z, d = S(1) - inverseCoefficient(w2) * w2, h = S(0.5) * v.z;
  const Mat3<S> J = Jexp2(v);
  const S ux = J(0, 2), uy = J(1, 2);
  return {{d, -h, -(d * ux - h * uy), h, d, -(h * ux + d * uy), S(0), S(0), S(1)}};
}
/// @}

}  // namespace dyn
