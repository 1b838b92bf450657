// SPDX-License-Identifier: BSD-2-Clause
// Joints as libraries with a static variant write them: a class for each axis, a base class that has the derived class as template argument (CRTP),
// and a closed std::variant. Each class exploits its own sparsity, computes its own sine and cosine, and keeps its axis as the model gives it.
#pragma once

#include <dyn/lie/so3.hpp>
#include <dyn/spatial/se3.hpp>

#include <cmath>
#include <variant>

namespace dyn::benchmark::pattern {

using Vector = Vec3<double>;
using Matrix = Mat3<double>;
using Pose = SE3<double>;
using Velocity = Motion<double>;
using Wrench = Force<double>;

template <class Derived>
struct JointBase {
  int idx_q = 0, idx_v = 0;

  const Derived& derived() const { return static_cast<const Derived&>(*this); }
  /// Returns `placement` times the joint's own pose.
  Pose place(const Pose& placement, const double* q) const { return derived().placeImpl(placement, q + idx_q); }
  Velocity times(const double* v) const { return derived().timesImpl(v + idx_v); }
  Velocity column(int k) const { return derived().columnImpl(k); }
  void project(const Wrench& f, double* tau) const { derived().projectImpl(f, tau + idx_v); }
};

/// E times the rotation with cosine c and sine s about coordinate axis `axis`.
template <int axis>
Matrix turned(const Matrix& E, double c, double s) {
  constexpr int a = (axis + 1) % 3, b = (axis + 2) % 3;
  Matrix R;
  for (int i = 0; i < 3; ++i) {
    R(i, axis) = E(i, axis);
    R(i, a) = E(i, a) * c + E(i, b) * s;
    R(i, b) = E(i, b) * c - E(i, a) * s;
  }
  return R;
}
template <int axis>
Vector along(double x) {
  Vector v;
  v[axis] = x;
  return v;
}
/// Rotation about the unit vector n with cosine c and sine s, by Rodrigues' formula.
inline Matrix rotation(const Vector& n, double c, double s) {
  const Vector k = (1 - c) * n;
  return {{c + k.x * n.x, k.x * n.y - s * n.z, k.x * n.z + s * n.y, k.y * n.x + s * n.z, c + k.y * n.y, k.y * n.z - s * n.x, k.z * n.x - s * n.y,
           k.z * n.y + s * n.x, c + k.z * n.z}};
}

/// Cosine and sine of a revolute joint. q is the angle, or, if `unbounded`, the cosine and sine themselves, which are normalised.
template <bool unbounded>
struct Angle {
  double c, s;
  explicit Angle(const double* q) : c(unbounded ? q[0] : std::cos(q[0])), s(unbounded ? q[1] : std::sin(q[0])) {
    if constexpr (unbounded) {
      const double scale = 1 / std::sqrt(c * c + s * s);
      c *= scale;
      s *= scale;
    }
  }
};

template <int axis, bool unbounded>
struct Revolute : JointBase<Revolute<axis, unbounded>> {
  static constexpr int nv = 1;
  Pose placeImpl(const Pose& X, const double* q) const {
    const Angle<unbounded> angle(q);
    return {turned<axis>(X.R, angle.c, angle.s), X.p};
  }
  Velocity timesImpl(const double* v) const { return {{}, along<axis>(v[0])}; }
  Velocity columnImpl(int) const { return {{}, along<axis>(1)}; }
  void projectImpl(const Wrench& f, double* tau) const { tau[0] = f.angular[axis]; }
};

template <bool unbounded>
struct RevoluteUnaligned : JointBase<RevoluteUnaligned<unbounded>> {
  static constexpr int nv = 1;
  Vector axis;
  Pose placeImpl(const Pose& X, const double* q) const {
    const Angle<unbounded> angle(q);
    return {X.R * rotation(axis, angle.c, angle.s), X.p};
  }
  Velocity timesImpl(const double* v) const { return {{}, v[0] * axis}; }
  Velocity columnImpl(int) const { return {{}, axis}; }
  void projectImpl(const Wrench& f, double* tau) const { tau[0] = dot(axis, f.angular); }
};

template <int axis>
struct Prismatic : JointBase<Prismatic<axis>> {
  static constexpr int nv = 1;
  Pose placeImpl(const Pose& X, const double* q) const { return {X.R, X.p + q[0] * X.R.col(axis)}; }
  Velocity timesImpl(const double* v) const { return {along<axis>(v[0]), {}}; }
  Velocity columnImpl(int) const { return {along<axis>(1), {}}; }
  void projectImpl(const Wrench& f, double* tau) const { tau[0] = f.linear[axis]; }
};

struct PrismaticUnaligned : JointBase<PrismaticUnaligned> {
  static constexpr int nv = 1;
  Vector axis;
  Pose placeImpl(const Pose& X, const double* q) const { return {X.R, X.p + X.R * (q[0] * axis)}; }
  Velocity timesImpl(const double* v) const { return {v[0] * axis, {}}; }
  Velocity columnImpl(int) const { return {axis, {}}; }
  void projectImpl(const Wrench& f, double* tau) const { tau[0] = dot(axis, f.linear); }
};

inline Matrix rotationOf(const double* q) { return Quaternion<double>{q[0], q[1], q[2], q[3]}.normalized().matrix(); }

struct Spherical : JointBase<Spherical> {
  static constexpr int nv = 3;
  Pose placeImpl(const Pose& X, const double* q) const { return {X.R * rotationOf(q), X.p}; }
  Velocity timesImpl(const double* v) const { return {{}, {v[0], v[1], v[2]}}; }
  Velocity columnImpl(int k) const {
    Velocity s;
    s.angular[k] = 1;
    return s;
  }
  void projectImpl(const Wrench& f, double* tau) const {
    for (int k = 0; k < 3; ++k) tau[k] = f.angular[k];
  }
};

struct FreeFlyer : JointBase<FreeFlyer> {
  static constexpr int nv = 6;
  Pose placeImpl(const Pose& X, const double* q) const { return X * Pose{rotationOf(q + 3), {q[0], q[1], q[2]}}; }
  Velocity timesImpl(const double* v) const { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }
  Velocity columnImpl(int k) const {
    Velocity s;
    (k < 3 ? s.linear[k] : s.angular[k - 3]) = 1;
    return s;
  }
  void projectImpl(const Wrench& f, double* tau) const {
    for (int k = 0; k < 3; ++k) {
      tau[k] = f.linear[k];
      tau[3 + k] = f.angular[k];
    }
  }
};

using Joint =
    std::variant<Revolute<0, false>, Revolute<1, false>, Revolute<2, false>, RevoluteUnaligned<false>, Revolute<0, true>, Revolute<1, true>,
                 Revolute<2, true>, RevoluteUnaligned<true>, Prismatic<0>, Prismatic<1>, Prismatic<2>, PrismaticUnaligned, Spherical, FreeFlyer>;

}  // namespace dyn::benchmark::pattern
