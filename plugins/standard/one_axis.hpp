// SPDX-License-Identifier: BSD-2-Clause
// Joints about or along one axis: revolute, continuous, prismatic, helical, cylindrical; and fixed. The axis is any vector; the core motion is about
// or along z.
#pragma once

#include <dyn/lie/se2.hpp>
#include <dyn_sdk/joint_plugin.hpp>

namespace dyn::standard {

inline constexpr ParameterSpec axis_parameter{"axis", ParameterKind::vector3, true, "", "direction in the joint frame, any length but zero"};

/// Turns the joint frame so that its z lies along the axis: motion = A core(q) A^-1.
inline bool alignZ(const double* axis, JointInstance& out, const sdk::Refusal& refuse) {
  Vec3<long double> n;
  if (!sdk::unitVector(axis, n)) return refuse("axis must be a finite vector other than zero");
  out.before.R = sdk::frameWithZ(n);
  out.after.R = transpose(out.before.R);
  return true;
}

struct Fixed : sdk::Joint<Fixed, 0> {
  static constexpr const char* name = "fixed";
  static constexpr const char* summary = "no motion; the compiler welds it";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::translation;
  template <class S>
  static void coordinates(const S*, const auto&, S* p) {
    p[0] = p[1] = p[2] = S(0);
  }
};

struct Revolute : sdk::Joint<Revolute, 1> {
  static constexpr const char* name = "revolute";
  static constexpr const char* summary = "rotation about an axis by q [rad]";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::revolute;
  static constexpr std::array parameters{axis_parameter};
  static int constantCount(const ParameterArgument*) { return 0; }
  static void constants(const ParameterArgument*, double*) {}
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) { return alignZ(a[0].numbers, out, refuse); }
  template <class S>
  static void coordinates(const S* q, const auto&, S* pose) {
    sincos(q[0], pose[1], pose[0]);
  }
};

struct Continuous : sdk::Joint<Continuous, 1, 2> {
  static constexpr const char* name = "continuous";
  static constexpr const char* summary = "rotation about an axis, q = (cos, sin)";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::revolute;
  static constexpr std::array parameters{axis_parameter};
  static int constantCount(const ParameterArgument*) { return 0; }
  static void constants(const ParameterArgument*, double*) {}
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) { return alignZ(a[0].numbers, out, refuse); }
  template <class S>
  static void coordinates(const S* q, const auto&, S* pose) {
    const SO2<S> r = SO2<S>{q[0], q[1]}.normalized();
    pose[0] = r.c;
    pose[1] = r.s;
  }
  static void neutral(double* q) {
    q[0] = 1;
    q[1] = 0;
  }
  static void integrate(const double* q, const double* v, double* out) {
    const SO2<double> r = SO2<double>{q[0], q[1]}.normalized() * SO2<double>::exp(v[0]);
    out[0] = r.c;
    out[1] = r.s;
  }
  static void difference(const double* a, const double* b, double* v) {
    v[0] = (SO2<double>{a[0], a[1]}.normalized().inverse() * SO2<double>{b[0], b[1]}.normalized()).log();
  }
  static void dIntegrate(const double*, const double*, double* Jq, double* Jv) { Jq[0] = Jv[0] = 1; }
  static void dDifference(const double*, const double*, double* J0, double* J1) {
    J0[0] = -1;
    J1[0] = 1;
  }
  static double normalize(double* q) {
    const double n = std::hypot(q[0], q[1]);
    const SO2<double> r = SO2<double>{q[0], q[1]}.normalized();
    q[0] = r.c;
    q[1] = r.s;
    return std::fabs(n - 1);
  }
};

struct Prismatic : sdk::Joint<Prismatic, 1> {
  static constexpr const char* name = "prismatic";
  static constexpr const char* summary = "translation along an axis by q [m]";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::prismatic;
  static constexpr std::array parameters{axis_parameter};
  static int constantCount(const ParameterArgument*) { return 0; }
  static void constants(const ParameterArgument*, double*) {}
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) { return alignZ(a[0].numbers, out, refuse); }
  template <class S>
  static void coordinates(const S* q, const auto&, S* pose) {
    pose[0] = q[0];
  }
};

/// Rotation about z with cosine c and sine s, and a translation by z along it.
template <class S>
SE3<S> screwPose(const S& c, const S& s, const S& z) {
  return {{{c, -s, S(0), s, c, S(0), S(0), S(0), S(1)}}, {S(0), S(0), z}};
}

struct Helical : sdk::Joint<Helical, 1> {
  static constexpr const char* name = "helical";
  static constexpr const char* summary = "rotation about an axis by q [rad] with a translation pitch q along it";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::dense_constant;
  static constexpr std::array parameters{axis_parameter,
                                         ParameterSpec{"pitch", ParameterKind::number, true, "m/rad", "translation along the axis per radian"}};
  static int constantCount(const ParameterArgument*) { return 1; }
  static void constants(const ParameterArgument* a, double* out) { out[0] = a[1].numbers[0]; }
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) {
    out.subspace[2] = a[1].numbers[0];
    out.subspace[5] = 1;
    return alignZ(a[0].numbers, out, refuse);
  }
  template <class S>
  static SE3<S> pose(const S* q, const auto& c) {
    S cosine, sine;
    sincos(q[0], sine, cosine);
    return screwPose(cosine, sine, S(c[0]) * q[0]);
  }
};

struct Cylindrical : sdk::Joint<Cylindrical, 2> {
  static constexpr const char* name = "cylindrical";
  static constexpr const char* summary = "rotation about an axis by q[0] [rad] and translation along it by q[1] [m]";
  static constexpr bool branch_free = true;
  static constexpr Shape shape = Shape::dense_constant;
  static constexpr std::array parameters{axis_parameter};
  static int constantCount(const ParameterArgument*) { return 0; }
  static void constants(const ParameterArgument*, double*) {}
  static bool check(const ParameterArgument* a, JointInstance& out, const sdk::Refusal& refuse) {
    out.subspace[5] = 1;
    out.subspace[6 + 2] = 1;
    return alignZ(a[0].numbers, out, refuse);
  }
  template <class S>
  static SE3<S> pose(const S* q, const auto&) {
    S cosine, sine;
    sincos(q[0], sine, cosine);
    return screwPose(cosine, sine, q[1]);
  }
};

}  // namespace dyn::standard
