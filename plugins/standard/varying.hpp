// SPDX-License-Identifier: BSD-2-Clause
// Joints whose motion subspace depends on q: universal, spherical_zyx, ellipsoid.
#pragma once

#include "one_axis.hpp"

namespace dyn::standard {

struct Universal : sdk::Joint<Universal, 2> {
  static constexpr const char* name = "universal";
  static constexpr const char* summary = "rotation about axis by q[0], then about axis2 (fixed to the turned frame) by q[1] [rad]";
  static constexpr bool branch_free = true;
  static constexpr std::array parameters{axis_parameter,
                                         ParameterSpec{"axis2", ParameterKind::vector3, true, "", "second axis, not parallel to the first"}};
  static int constantCount(const ParameterArgument*) { return 6; }
  static void constants(const ParameterArgument* a, double* out) {
    for (int i = 0; i < 2; ++i) {
      Vec3<long double> n;
      sdk::unitVector(a[i].numbers, n);
      for (int k = 0; k < 3; ++k) out[3 * i + k] = static_cast<double>(n[k]);
    }
  }
  static bool check(const ParameterArgument* a, JointInstance&, const sdk::Refusal& refuse) {
    Vec3<long double> m, n;
    if (!sdk::unitVector(a[0].numbers, m) || !sdk::unitVector(a[1].numbers, n))
      return refuse("axis and axis2 must be finite vectors other than zero");
    const Vec3<long double> c = cross(m, n);
    return dot(c, c) > 1e-24 || refuse("axis and axis2 must not be parallel");
  }
  template <class S>
  static Vec3<S> axis(const auto& c, int k) {
    return {S(c[3 * k]), S(c[3 * k + 1]), S(c[3 * k + 2])};
  }
  /// Rotation about the unit vector n by the angle with cosine c and sine s.
  template <class S>
  static Mat3<S> turn(const Vec3<S>& n, const S& c, const S& s) {
    Mat3<S> R = s * skew(n);
    const S omc = S(1) - c;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) R(i, j) += omc * n[i] * n[j];
    for (int i = 0; i < 3; ++i) R(i, i) += c;
    return R;
  }
  template <class S>
  static SE3<S> pose(const S* q, const auto& c) {
    using std::cos, std::sin;
    return {turn(axis<S>(c, 0), S(cos(q[0])), S(sin(q[0]))) * turn(axis<S>(c, 1), S(cos(q[1])), S(sin(q[1]))), {}};
  }
  /// S = (R2^T n1, n2) and, at constant v, S' v = R2^T (n1 x n2) v1 v2.
  template <class S>
  static void subspace(const S* q, const auto& c, Motion<S>* columns) {
    using std::cos, std::sin;
    const Vec3<S> n2 = axis<S>(c, 1);
    columns[0] = {{}, transposeTimes(turn(n2, S(cos(q[1])), S(sin(q[1]))), axis<S>(c, 0))};
    columns[1] = {{}, n2};
  }
  template <class S>
  static Motion<S> bias(const S* q, const S* v, const auto& c) {
    using std::cos, std::sin;
    const Vec3<S> n2 = axis<S>(c, 1);
    const Mat3<S> R2 = turn(n2, S(cos(q[1])), S(sin(q[1])));
    return {{}, (v[0] * v[1]) * transposeTimes(R2, cross(axis<S>(c, 0), n2))};
  }
};

struct SphericalZYX : sdk::Joint<SphericalZYX, 3> {
  static constexpr const char* name = "spherical_zyx";
  static constexpr const char* summary = "rotation Rz(q[0]) Ry(q[1]) Rx(q[2]) [rad], v = dq/dt; singular at q[1] = +-pi/2";
  static constexpr bool branch_free = true;
  template <class S>
  static SE3<S> pose(const S* q, const auto&) {
    using std::cos, std::sin;
    const S cz = cos(q[0]), sz = sin(q[0]), cy = cos(q[1]), sy = sin(q[1]), cx = cos(q[2]), sx = sin(q[2]);
    return {{{cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,  //
              sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,  //
              -sy, cy * sx, cy * cx}},
            {}};
  }
  template <class S>
  static void subspace(const S* q, const auto&, Motion<S>* columns) {
    using std::cos, std::sin;
    const S cy = cos(q[1]), sy = sin(q[1]), cx = cos(q[2]), sx = sin(q[2]);
    columns[0] = {{}, {-sy, cy * sx, cy * cx}};
    columns[1] = {{}, {S(0), cx, -sx}};
    columns[2] = {{}, {S(1), S(0), S(0)}};
  }
  template <class S>
  static Motion<S> bias(const S* q, const S* v, const auto&) {
    using std::cos, std::sin;
    const S cy = cos(q[1]), sy = sin(q[1]), cx = cos(q[2]), sx = sin(q[2]);
    const S a = v[0] * v[1], b = v[0] * v[2], c = v[1] * v[2];
    return {{}, {-(cy * a), -(sy * sx * a) + cy * cx * b - sx * c, -(sy * cx * a) - cy * sx * b - cx * c}};
  }
};

/// The frame turns by Rx(q0) Ry(q1) Rz(q2). Its origin stays on an ellipsoid: it is the turned z, scaled by the half axes (Seth et al. 2010).
struct Ellipsoid : sdk::Joint<Ellipsoid, 3> {
  static constexpr const char* name = "ellipsoid";
  static constexpr const char* summary = "rotation Rx(q[0]) Ry(q[1]) Rz(q[2]) [rad], the origin on the ellipsoid where its normal-like z points";
  static constexpr bool branch_free = true;
  static constexpr std::array parameters{
      ParameterSpec{"radii", ParameterKind::vector3, true, "m", "half axes of the ellipsoid, not negative", "0.1 0.2 0.15"}};
  static bool check(const ParameterArgument* a, JointInstance&, const sdk::Refusal& refuse) {
    for (int i = 0; i < 3; ++i)
      if (!(a[0].numbers[i] >= 0)) return refuse("radii must not be negative");
    return true;
  }
  template <class S>
  static SE3<S> pose(const S* q, const auto& c) {
    using std::cos, std::sin;
    const S cx = cos(q[0]), sx = sin(q[0]), cy = cos(q[1]), sy = sin(q[1]), cz = cos(q[2]), sz = sin(q[2]);
    return {{{cy * cz, -(cy * sz), sy,                                     //
              cx * sz + sx * sy * cz, cx * cz - sx * sy * sz, -(sx * cy),  //
              sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy}},
            {S(c[0]) * sy, -(S(c[1]) * sx * cy), S(c[2]) * cx * cy}};
  }
};

}  // namespace dyn::standard
