// SPDX-License-Identifier: BSD-2-Clause
// A joint that points: its coordinates are the unit vector n that its z axis points along. It does not twist about n.
#include <dyn_sdk/joint_plugin.hpp>

struct Direction : dyn::sdk::Joint<Direction, 2, 3> {
  static constexpr const char* name = "direction";
  static constexpr const char* summary = "q = n, the unit vector that z points along; v: angular velocity about the moved x and y [rad/s]";
  static constexpr bool branch_free = true;

  /// The smallest rotation that takes z to n. Its columns are the moved x, the moved y and n. There is none for n = -z.
  template <class S>
  static dyn::Mat3<S> axes(const S* n) {
    const S k = S(1) / (S(1) + n[2]);
    return {{S(1) - k * n[0] * n[0], -(k * n[0] * n[1]), n[0], -(k * n[0] * n[1]), S(1) - k * n[1] * n[1], n[1], -n[0], -n[1], n[2]}};
  }
  /// Writes the unit vector along q, and returns the length of q, which rounding may have moved away from 1.
  template <class S>
  static S unit(const S* q, S* n) {
    using std::sqrt;
    S length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    for (int i = 0; i < 3; ++i) n[i] = q[i] / length;
    return length;
  }
  template <class S>
  static dyn::SE3<S> pose(const S* q, const auto&) {
    S n[3];
    unit(q, n);
    return {axes(n), {}};
  }

  static void neutral(double* q) {
    q[0] = q[1] = 0;
    q[2] = 1;
  }
  /// The angular velocity v moves n along (v[1], -v[0], 0) in the moved axes.
  template <class S>
  static void rates(const S* q, const S* v, const auto&, S* dq) {
    S n[3];
    const S length = unit(q, n);
    const dyn::Vec3<S> dn = axes(n) * dyn::Vec3<S>{v[1], -v[0], S(0)};
    for (int i = 0; i < 3; ++i) dq[i] = length * dn[i];
  }
  /// Moves n by the angle |v| along the great circle that starts in the direction of rates().
  template <class S>
  static void integrate(const S* q, const S* v, S* out) {
    using std::cos, std::sin, std::sqrt;
    const S angle = sqrt(v[0] * v[0] + v[1] * v[1]), share = angle > S(0) ? S(sin(angle) / angle) : S(1);
    const dyn::Vec3<S> n = axes(q) * dyn::Vec3<S>{share * v[1], -(share * v[0]), cos(angle)};
    for (int i = 0; i < 3; ++i) out[i] = n[i];
    normalize(out);
  }
  static void difference(const double* from, const double* to, double* v) {
    // The difference is taken in the moved axes, so that a small one keeps its digits.
    const dyn::Vec3<double> way = transposeTimes(axes(from), dyn::Vec3<double>{to[0] - from[0], to[1] - from[1], to[2] - from[2]});
    const double sine = std::hypot(way.x, way.y), share = sine > 0 ? std::atan2(sine, 1 + way.z) / sine : 1;
    v[0] = -share * way.y;
    v[1] = share * way.x;
  }
  template <class S>
  static S normalize(S* q) {
    using std::abs;
    return abs(unit(q, q) - S(1));
  }
};

DYN_EXPORT_JOINTS(Direction)
