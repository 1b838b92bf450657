// SPDX-License-Identifier: BSD-2-Clause
// Joints whose configuration space is a Lie group: spherical, free_flyer, planar; and the flat translation.
#pragma once

#include "one_axis.hpp"

#include <dyn/lie/se3.hpp>

namespace dyn::standard {

/// Returns the quaternion that starts at q, normalised.
template <class S>
Quaternion<S> quaternionAt(const S* q) {
  return Quaternion<S>{q[0], q[1], q[2], q[3]}.normalized();
}
inline void writeQuaternion(const Quaternion<double>& r, double* q) {
  q[0] = r.x;
  q[1] = r.y;
  q[2] = r.z;
  q[3] = r.w;
}
/// Normalises the quaternion at q; returns | |q| - 1 |.
inline double normalizeQuaternion(double* q) {
  const double n = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  writeQuaternion(quaternionAt(q), q);
  return std::fabs(n - 1);
}
/// q1 (-) q0 of two unit quaternions; exactly zero for q1 = -q0.
inline Vec3<double> quaternionDifference(const Quaternion<double>& q0, const Quaternion<double>& q1) { return log3(q0.conjugate() * q1); }
inline void writeMatrix(const Mat3<double>& M, double* out) {
  for (int i = 0; i < 9; ++i) out[i] = M.m[i];
}
inline void writeBlocks(const Jacobian6<double>& J, double sign, double* out) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      out[6 * i + j] = out[6 * (i + 3) + j + 3] = sign * J.diagonal(i, j);
      out[6 * i + j + 3] = sign * J.upper(i, j);
      out[6 * (i + 3) + j] = 0;
    }
}

struct Spherical : sdk::Joint<Spherical, 3, 4> {
  static constexpr const char* name = "spherical";
  static constexpr const char* summary = "rotation by the quaternion q = (x, y, z, w); v: angular velocity in the moving frame [rad/s]";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::spherical;
  template <class S>
  static void coordinates(const S* q, const sdk::Constants&, S* pose) {
    const Mat3<S> R = Quaternion<S>{q[0], q[1], q[2], q[3]}.matrix();
    for (int i = 0; i < 9; ++i) pose[i] = R.m[i];
  }
  static void neutral(double* q) { writeQuaternion({}, q); }
  static void integrate(const double* q, const double* v, double* out) {
    writeQuaternion(quaternionAt(q) * expQuaternion(Vec3<double>{v[0], v[1], v[2]}), out);
  }
  static void difference(const double* a, const double* b, double* v) {
    const Vec3<double> d = quaternionDifference(quaternionAt(a), quaternionAt(b));
    for (int i = 0; i < 3; ++i) v[i] = d[i];
  }
  static void dIntegrate(const double*, const double* v, double* Jq, double* Jv) {
    const Vec3<double> w{v[0], v[1], v[2]};
    writeMatrix(transpose(exp3(w)), Jq);
    writeMatrix(Jexp3(w), Jv);
  }
  static void dDifference(const double* a, const double* b, double* J0, double* J1) {
    const Mat3<double> J = Jlog3(quaternionDifference(quaternionAt(a), quaternionAt(b)));
    writeMatrix(J, J1);
    writeMatrix(-1.0 * transpose(J), J0);  // Jlog(d) exp(-d) = Jlog(-d) = Jlog(d)^T
  }
  static double normalize(double* q) { return normalizeQuaternion(q); }
};

struct FreeFlyer : sdk::Joint<FreeFlyer, 6, 7> {
  static constexpr const char* name = "free_flyer";
  static constexpr const char* summary = "q = (position [m], quaternion xyzw); v = (linear, angular) in the moving frame";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::free;
  template <class S>
  static void coordinates(const S* q, const sdk::Constants&, S* pose) {
    const Mat3<S> R = Quaternion<S>{q[3], q[4], q[5], q[6]}.matrix();
    for (int i = 0; i < 9; ++i) pose[i] = R.m[i];
    for (int i = 0; i < 3; ++i) pose[9 + i] = q[i];
  }
  static Motion<double> motionAt(const double* v) { return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}}; }
  static void neutral(double* q) {
    q[0] = q[1] = q[2] = 0;
    writeQuaternion({}, q + 3);
  }
  static void integrate(const double* q, const double* v, double* out) {
    const Quaternion<double> r = quaternionAt(q + 3);
    const Motion<double> m = motionAt(v);
    const Vec3<double> p = r.matrix() * transposeTimes(Jexp3(m.angular), m.linear);
    for (int i = 0; i < 3; ++i) out[i] = q[i] + p[i];
    writeQuaternion(r * expQuaternion(m.angular), out + 3);
  }
  /// Returns b (-) a, and in D the Jlog3 of its rotation.
  static Motion<double> minus(const double* a, const double* b, Mat3<double>& D) {
    const Quaternion<double> ra = quaternionAt(a + 3);
    const Vec3<double> w = quaternionDifference(ra, quaternionAt(b + 3));
    D = Jlog3(w);
    return {transposeTimes(D, transposeTimes(ra.matrix(), Vec3<double>{b[0] - a[0], b[1] - a[1], b[2] - a[2]})), w};
  }
  static void difference(const double* a, const double* b, double* v) {
    Mat3<double> D;
    const Motion<double> d = minus(a, b, D);
    for (int i = 0; i < 3; ++i) {
      v[i] = d.linear[i];
      v[3 + i] = d.angular[i];
    }
  }
  static void dIntegrate(const double*, const double* v, double* Jq, double* Jv) {
    const Motion<double> m = motionAt(v);
    writeBlocks(actionMatrix(exp6(-1.0 * m)), 1, Jq);
    writeBlocks(Jexp6(m), 1, Jv);
  }
  static void dDifference(const double* a, const double* b, double* J0, double* J1) {
    Mat3<double> D;
    const Motion<double> d = minus(a, b, D);
    const Jacobian6<double> J = Jlog6(d, D);
    writeBlocks(J, 1, J1);
    writeBlocks(opposite(J), -1, J0);  // Jlog(d) Ad(exp(-d)) = Jlog(-d)
  }
  static double normalize(double* q) { return normalizeQuaternion(q + 3); }
};

struct Planar : sdk::Joint<Planar, 3, 4> {
  static constexpr const char* name = "planar";
  static constexpr const char* summary = "q = (x, y, cos, sin) in the plane normal to axis (default z); v = (vx, vy, w) in the moving frame";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::planar;
  static constexpr std::array parameters{
      ParameterSpec{"axis", ParameterKind::vector3, false, "", "normal of the plane in the joint frame, default 0 0 1"}};
  static int constantCount(const ParameterArgument*) { return 0; }
  static void constants(const ParameterArgument*, double*) {}
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) {
    return !a[0].given || alignZ(a[0].numbers, out, refuse);
  }
  template <class S>
  static SE2<S> at(const S* q) {
    return {q[0], q[1], SO2<S>{q[2], q[3]}.normalized()};
  }
  static void write(const SE2<double>& X, double* q) {
    q[0] = X.x;
    q[1] = X.y;
    q[2] = X.r.c;
    q[3] = X.r.s;
  }
  template <class S>
  static void coordinates(const S* q, const sdk::Constants&, S* pose) {
    const SE2<S> X = at(q);
    pose[0] = X.x;
    pose[1] = X.y;
    pose[2] = X.r.c;
    pose[3] = X.r.s;
  }
  static void neutral(double* q) { write({}, q); }
  static void integrate(const double* q, const double* v, double* out) { write(at(q) * SE2<double>::exp({v[0], v[1], v[2]}), out); }
  static Vec3<double> minus(const double* a, const double* b) {
    const SE2<double> A = at(a), B = at(b);
    // Positions are subtracted first: A^-1 * B would cancel far from the origin.
    const double dx = B.x - A.x, dy = B.y - A.y;
    return SE2<double>{A.r.c * dx + A.r.s * dy, A.r.c * dy - A.r.s * dx, A.r.inverse() * B.r}.log();
  }
  static void difference(const double* a, const double* b, double* v) {
    const Vec3<double> d = minus(a, b);
    for (int i = 0; i < 3; ++i) v[i] = d[i];
  }
  static void dIntegrate(const double*, const double* v, double* Jq, double* Jv) {
    const Vec3<double> d{v[0], v[1], v[2]};
    writeMatrix(SE2<double>::exp(-d).action(), Jq);
    writeMatrix(Jexp2(d), Jv);
  }
  static void dDifference(const double* a, const double* b, double* J0, double* J1) {
    const Vec3<double> d = minus(a, b);
    writeMatrix(Jlog2(d), J1);
    writeMatrix(-1.0 * Jlog2(-d), J0);
  }
  static double normalize(double* q) { return Continuous::normalize(q + 2); }
};

struct Translation : sdk::Joint<Translation, 3> {
  static constexpr const char* name = "translation";
  static constexpr const char* summary = "translation by q [m] in the joint frame";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::translation;
  template <class S>
  static void coordinates(const S* q, const sdk::Constants&, S* pose) {
    for (int i = 0; i < 3; ++i) pose[i] = q[i];
  }
};

}  // namespace dyn::standard
