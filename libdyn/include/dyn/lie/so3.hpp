// SPDX-License-Identifier: BSD-2-Clause
// Rotations: unit quaternions (x, y, z, w), exponential, logarithm and their Jacobians, accurate to rounding at every angle.
//
// At small angles, where the closed forms cancel, series replace them. At the switch both are accurate to a few ulp.
#pragma once

#include <dyn/scalar/dual.hpp>
#include <dyn/scalar/select.hpp>
#include <dyn/spatial/vector3.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <type_traits>

namespace dyn {

/// Returns the sum of four squares, correct to rounding if S is a number or a pack, since a rotation matrix inherits its whole error. Each number is
/// split into a leading part and a rest (Rump, Ogita, Oishi 2008). Leading parts have so few digits, relative to the largest number, that their
/// squares and the sum of these are exact.
template <class S>
S sumOfSquares(const S& x, const S& y, const S& z, const S& w) {
  using T = Real<S>;
  if constexpr (std::is_floating_point_v<T>) {
    using std::abs;
    constexpr int digits = (std::numeric_limits<T>::digits + 3) / 2;
    const S large = ((abs(x) + abs(y)) + (abs(z) + abs(w))) * S(static_cast<T>(1LL << digits));
    const auto lead = [&](const S& c) { return (c + large) - large; };
    const auto rest = [](const S& c, const S& first) { return (c - first) * (c + first); };
    const S a = lead(x), b = lead(y), c = lead(z), d = lead(w);
    return ((a * a + b * b) + (c * c + d * d)) + ((rest(x, a) + rest(y, b)) + (rest(z, c) + rest(w, d)));
  } else {
    return x * x + y * y + z * z + w * w;
  }
}

/// Quaternion of a rotation, the unit rotation by default.
template <class S>
struct Quaternion {
  /// Vector part (x, y, z) and scalar part w.
  /// @{
  S x{}, y{}, z{}, w{1};
  /// @}

  /// Returns the vector part.
  Vec3<S> vec() const { return {x, y, z}; }
  /// Returns the conjugate. For a unit quaternion it is the opposite rotation.
  Quaternion conjugate() const { return {-x, -y, -z, w}; }
  /// Returns the product, the rotation b followed by a. The terms are summed in pairs that cancel exactly in conj(q) q.
  friend Quaternion operator*(const Quaternion& a, const Quaternion& b) {
    return {(a.w * b.x + a.x * b.w) + (a.y * b.z - a.z * b.y), (a.w * b.y + a.y * b.w) + (a.z * b.x - a.x * b.z),
            (a.w * b.z + a.z * b.w) + (a.x * b.y - a.y * b.x), (a.w * b.w - a.x * b.x) - (a.y * b.y + a.z * b.z)};
  }
  /// Divides by the norm, without overflow or underflow. The zero quaternion gives NaN.
  Quaternion normalized() const {
    using std::abs, std::sqrt;
    S m = abs(x);
    for (const S& c : {abs(y), abs(z), abs(w)}) m = select(c > m, c, m);
    const S a = x / m, b = y / m, c = z / m, d = w / m;
    const S n = sqrt(a * a + b * b + c * c + d * d);
    return {a / n, b / n, c / n, d / n};
  }
  /// Returns the rotation matrix of a quaternion of any norm but zero. The products are divided by the squared norm, which saves one rounding over
  /// normalising first. The quaternion is normalised first only where the squared norm would overflow or lose digits.
  Mat3<S> matrix() const {
    const S n2 = sumOfSquares(x, y, z, w);
    const auto ordinary = both(n2 > S(1e-30), n2 < S(1e30));
    Mat3<S> R = unitMatrix(S(2) / n2);
    if (is_symbolic<S> || allOf(ordinary)) return R;
    const Mat3<S> careful = normalized().unitMatrix(S(2));
    for (int i = 0; i < 9; ++i) R.m[i] = select(ordinary, R.m[i], careful.m[i]);
    return R;
  }

 private:
  /// Rotation matrix for s = 2 / norm^2. The diagonal is a difference of sums of squares, which keeps every summand below one.
  Mat3<S> unitMatrix(const S& s) const {
    const S sx = s * x, sy = s * y, sz = s * z, h = S(0.5) * s;
    const S xx = x * x, yy = y * y, zz = z * z, ww = w * w;
    return {{h * ((ww + xx) - (yy + zz)), sx * y - sz * w, sx * z + sy * w,  //
             sx * y + sz * w, h * ((ww + yy) - (xx + zz)), sy * z - sx * w,  //
             sx * z - sy * w, sy * z + sx * w, h * ((ww + zz) - (xx + yy))}};
  }
};

/// Returns the unit quaternion with w >= 0 of a rotation matrix (Shepperd 1978: divides by the largest component).
template <class S>
Quaternion<S> quaternionOf(const Mat3<S>& R) {
  const S t = R(0, 0) + R(1, 1) + R(2, 2);
  Quaternion<S> q;
  if (t >= R(0, 0) && t >= R(1, 1) && t >= R(2, 2)) {
    q = {R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1), S(1) + t};
  } else {
    S c[3];
    const int i = R(0, 0) >= R(1, 1) ? (R(0, 0) >= R(2, 2) ? 0 : 2) : (R(1, 1) >= R(2, 2) ? 1 : 2);
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    c[i] = S(1) + R(i, i) - R(j, j) - R(k, k);
    c[j] = R(j, i) + R(i, j);
    c[k] = R(k, i) + R(i, k);
    q = {c[0], c[1], c[2], R(k, j) - R(j, k)};
  }
  q = q.normalized();
  if (q.w < S(0)) q = {-q.x, -q.y, -q.z, -q.w};
  return q;
}

namespace detail {
/// 1 / n! for n < 32, in extended precision.
inline constexpr auto inverse_factorials = [] {
  std::array<long double, 32> out{1};
  for (std::size_t n = 1; n < out.size(); ++n) out[n] = out[n - 1] / static_cast<long double>(n);
  return out;
}();

/// Sum of (-t2)^k / (2k + m)! from k = 0 to `last`, by Horner's scheme.
template <int m, int last, class S>
S alternatingSeries(const S& t2) {
  const auto coefficient = [](int k) {
    const long double x = inverse_factorials[static_cast<std::size_t>(2 * k + m)];
    if constexpr (std::is_same_v<S, long double>) {
      return x;
    } else {
      return S(static_cast<double>(x));
    }
  };
  S sum = coefficient(last);
  for (int k = last - 1; k >= 0; --k) sum = coefficient(k) - t2 * sum;
  return sum;
}

/// The same series, long enough for t < 2: the first term left out is less than 1e-20 of the sum.
template <int m, class S>
S rotationSeries(const S& t2) {
  return valueOf(t2) < 0x1p-4 ? alternatingSeries<m, 6>(t2) : alternatingSeries<m, 13>(t2);
}

/// sin t / t, where t2 = t^2.
template <class S>
S sinc(const S& t2) {
  using std::sin, std::sqrt;
  if (valueOf(t2) < 4.0) return rotationSeries<1>(t2);
  const S t = sqrt(t2);
  return sin(t) / t;
}
}  // namespace detail

/// Coefficients of the series of SO(3) and SE(3) at angle t, t2 = t^2.
template <class S>
struct RotationCoefficients {
  S a;  ///< sin t / t
  S b;  ///< (1 - cos t) / t^2
  S c;  ///< (t - sin t) / t^3
  S f;  ///< (a - 2 b) / t^2
  S g;  ///< (3 c - b) / t^2

  /// Takes coefficients that are known.
  RotationCoefficients(const S& a_, const S& b_, const S& c_, const S& f_, const S& g_) : a(a_), b(b_), c(c_), f(f_), g(g_) {}
  /// Computes the coefficients for t2 = t^2 [rad^2].
  explicit RotationCoefficients(const S& t2) {
    using std::sin, std::sqrt;
    a = detail::sinc(t2);
    if (valueOf(t2) < 4.0) {
      b = detail::rotationSeries<2>(t2);
      c = detail::rotationSeries<3>(t2);
      // With the sums of m = 4 and 5, b = 1/2 - t2 d and c = 1/6 - t2 e, which turns f and g into differences that do not cancel.
      const S d = detail::rotationSeries<4>(t2), e = detail::rotationSeries<5>(t2);
      f = S(2) * d - c;
      g = d - S(3) * e;
    } else {
      const S t = sqrt(t2), h = S(0.5) * t, s = sin(h) / h;
      b = S(0.5) * s * s;
      c = (S(1) - a) / t2;
      f = (a - S(2) * b) / t2;
      g = (S(3) * c - b) / t2;
    }
  }
};

/// Returns sin(x/2)^2, half of 1 - cos x, without cancellation; x2 is x^2 [rad^2].
template <class S>
S haversine(const S& x2) {
  const S a = detail::sinc(S(0.25) * x2);
  return S(0.25) * x2 * a * a;
}

/// Tells whether |w| >= 2 rad (isLargeRotation), or returns w in extended precision. The rounding of such an angle alone costs several roundings of
/// the result, so |w| and its sine are computed in extended precision there.
/// @{
inline bool isLargeRotation(const Vec3<double>& w) { return dot(w, w) >= 4; }
inline Vec3<long double> extended(const Vec3<double>& w) { return {w.x, w.y, w.z}; }
/// @}

/// Returns the coefficients at the angle |w| of a rotation vector [rad].
template <class S>
RotationCoefficients<S> rotationCoefficients(const Vec3<S>& w) {
  if constexpr (std::is_same_v<S, double>) {
    if (isLargeRotation(w)) {
      const RotationCoefficients<long double> k(dot(extended(w), extended(w)));
      const auto rounded = [](long double x) { return static_cast<double>(x); };
      return {rounded(k.a), rounded(k.b), rounded(k.c), rounded(k.f), rounded(k.g)};
    }
  }
  return RotationCoefficients<S>(dot(w, w));
}

/// Returns the unit quaternion of a rotation vector [rad].
template <class S>
Quaternion<S> expQuaternion(const Vec3<S>& w) {
  if constexpr (std::is_same_v<S, double>) {
    if (isLargeRotation(w)) {
      const Quaternion<long double> q = expQuaternion(extended(w));
      return {static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z), static_cast<double>(q.w)};
    }
  }
  using std::cos, std::sin, std::sqrt;
  const S t2 = dot(w, w);
  // For tiny w, t2 underflows; sin(t/2) / t is then 1/2, as it should be.
  const S h2 = S(0.25) * t2;
  const S s = S(0.5) * detail::sinc(h2);
  const S c = valueOf(h2) < 1 ? S(1) - S(2) * haversine(h2) : cos(S(0.5) * sqrt(t2));
  return {s * w.x, s * w.y, s * w.z, c};
}

/// Returns the rotation matrix of a rotation vector [rad], 1 + a [w] + b [w]^2.
template <class S>
Mat3<S> exp3(const Vec3<S>& w) {
  const RotationCoefficients<S> k = rotationCoefficients(w);
  const S bx = k.b * w.x, by = k.b * w.y, bz = k.b * w.z;
  const S ax = k.a * w.x, ay = k.a * w.y, az = k.a * w.z;
  return {{S(1) - (by * w.y + bz * w.z), bx * w.y - az, bx * w.z + ay,  //
           bx * w.y + az, S(1) - (bx * w.x + bz * w.z), by * w.z - ax,  //
           bx * w.z - ay, by * w.z + ax, S(1) - (bx * w.x + by * w.y)}};
}

/// Returns the rotation vector [rad] of a unit quaternion or a rotation matrix, of norm at most pi. q and -q give the same vector unless q.w is zero:
/// then the norm is pi and the two vectors are opposite.
/// @{
template <class S>
Vec3<S> log3(const Quaternion<S>& q) {
  using std::atan2, std::sqrt;
  const bool flip = valueOf(q.w) < 0;
  const Vec3<S> v = flip ? -q.vec() : q.vec();
  const S w = flip ? -q.w : q.w;
  const S n2 = dot(v, v);
  // The vector is 2 atan2(n, w) / n v. For small n it is 2 v / w (1 - n^2 / (3 w^2) + ...), which needs no root of a number that may underflow.
  if (valueOf(n2) < 1e-9) {
    const S r = n2 / (w * w);
    return (S(2) / w * (S(1) - r * (S(1.0 / 3.0) - r * S(0.2)))) * v;
  }
  const S n = sqrt(n2);
  return (S(2) * atan2(n, w) / n) * v;
}
template <class S>
Vec3<S> log3(const Mat3<S>& R) {
  return log3(quaternionOf(R));
}
/// @}

/// Returns the 3 x 3 right Jacobian of exp: exp(w + d) = exp(w) exp(J d + ...), with J = 1 - b [w] + c [w]^2 (Sola et al. 2018, eq. 143).
template <class S>
Mat3<S> Jexp3(const Vec3<S>& w) {
  const RotationCoefficients<S> k = rotationCoefficients(w);
  Mat3<S> J;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) J(i, j) = k.c * (w[i] * w[j]);
  for (int i = 0; i < 3; ++i) J(i, i) += k.a;  // 1 - c t^2 = a
  const Vec3<S> bw = k.b * w;
  J(0, 1) += bw.z;
  J(0, 2) -= bw.y;
  J(1, 0) -= bw.z;
  J(1, 2) += bw.x;
  J(2, 0) += bw.y;
  J(2, 1) -= bw.x;
  return J;
}

/// Returns g = (1 - t/2 cot(t/2)) / t^2, the last coefficient of the inverse Jacobian, for t2 = t^2 [rad^2].
/// It is regular at 0 and unbounded at 2 pi.
template <class S>
S inverseCoefficient(const S& t2) {
  using std::cos, std::sin, std::sqrt;
  if (valueOf(t2) < 2.25) {
    // (1 - a / (2 b)) / t2 = -f / (2 b): a quotient of two series, without cancellation.
    const RotationCoefficients<S> k(t2);
    return -k.f / (S(2) * k.b);
  }
  const S h = S(0.5) * sqrt(t2);
  return (S(1) - h * cos(h) / sin(h)) / t2;
}

/// Returns the inverse of Jexp3: log(exp(w) exp(d)) = w + J d + ..., with J = 1 + [w]/2 + g [w]^2.
template <class S>
Mat3<S> Jlog3(const Vec3<S>& w) {
  const S t2 = dot(w, w), g = inverseCoefficient(t2);
  Mat3<S> J;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) J(i, j) = g * (w[i] * w[j]);
  const S diagonal = S(1) - g * t2;
  for (int i = 0; i < 3; ++i) J(i, i) += diagonal;
  const Vec3<S> h = S(0.5) * w;
  J(0, 1) -= h.z;
  J(0, 2) += h.y;
  J(1, 0) += h.z;
  J(1, 2) -= h.x;
  J(2, 0) -= h.y;
  J(2, 1) += h.x;
  return J;
}

}  // namespace dyn
