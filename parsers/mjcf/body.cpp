// SPDX-License-Identifier: BSD-2-Clause
#include "body.hpp"

#include "common/inertia.hpp"

#include <dyn/lie/so3.hpp>

#include <Eigen/Eigenvalues>

#include <cmath>
#include <cstring>

namespace dyn::mjcf {

namespace {

using Matrix = Eigen::Matrix<long double, 3, 3>;

Eigen::SelfAdjointEigenSolver<Matrix> principal(const Sym3<long double>& I) {
  Matrix M;
  M << I.xx, I.xy, I.xz, I.xy, I.yy, I.yz, I.xz, I.yz, I.zz;
  return Eigen::SelfAdjointEigenSolver<Matrix>(M);
}

/// Refuses or notes what no body has.
void checkPhysical(const Values& v, const Inertia<long double>& Y, Inertias inertias, const Context& c) {
  const reader::InertiaFaults faults = reader::faultsOf(cast<double>(Y));
  const Where where = c.source.where(v.element());
  if (faults.point) c.notes.count(std::string("<inertial>: ") + reader::point_words, where);
  if (faults.massless) c.notes.count(std::string("<inertial>: ") + reader::massless_words, where);
  if (faults.indefinite && inertias == Inertias::physical) v.fail(v.described() + ": " + reader::indefinite_words + reader::anyway_words);
  if (faults.indefinite) {
    c.notes.count(std::string("<inertial>: ") + reader::indefinite_words, where);
  } else if (faults.unreal && !c.settings.balance_inertia) {
    c.notes.count(std::string("<inertial>: ") + reader::unreal_words, where);
  }
}

/// Reads a range that an attribute `limited` switches on. Returns false if there is none.
bool readRange(const Values& v, const char* range, const char* limited, const Context& c, double& lower, double& upper) {
  enum { no, yes, automatic };
  const int limit = v.word(limited, {"false", "true", "auto"}, automatic);
  std::vector<double> x{0, 0};
  if (v.has(range)) x = v.numbers(range, 2, 2);
  lower = x[0];
  upper = x[1];
  const bool given = lower != 0 || upper != 0;
  if (limit == automatic && given && !c.settings.autolimits)
    v.fail(v.described() + " has a " + range + " but does not say whether it holds; write " + limited +
           "=\"true\", or <compiler autolimits=\"true\"/>");
  if (limit == no || (limit == automatic && !given)) return false;
  return true;
}

Vec3<long double> axisOf(const Values& v) {
  const Vec3<long double> axis = v.vector3("axis", {0, 0, 1});
  if (!(dot(axis, axis) > 1e-28L)) v.fail(v.described() + ": its axis is zero; give it a direction");
  return axis;
}

/// Reads limits, damping, friction and armature for a joint of `nv` degrees of freedom.
void readCommon(const Values& v, std::size_t nv, bool ball, bool hinge, const Context& c, JointDescription& j) {
  double lower = 0, upper = 0;
  const Where where = c.source.where(v.element());
  if (nv != 6 && readRange(v, "range", "limited", c, lower, upper)) {
    if (lower >= upper && !ball) v.fail(v.described() + ": the first number of its range is not below the second");
    if (ball) {
      c.notes.count("ignored: the range of a ball joint, an angle about any axis", where);
    } else {
      const auto bound = [&](double x) { return hinge ? static_cast<double>(c.settings.angle(x)) : x; };
      j.limits.lower = {bound(lower)};
      j.limits.upper = {bound(upper)};
    }
  }
  if (nv == 1 && readRange(v, "actuatorfrcrange", "actuatorfrclimited", c, lower, upper)) {
    if (lower >= upper) v.fail(v.described() + ": the first number of its actuatorfrcrange is not below the second");
    if (lower != -upper) c.notes.count("an uneven actuatorfrcrange became the effort limit of its larger side", where);
    j.limits.effort = {std::max(std::fabs(lower), std::fabs(upper))};
  }
  const auto each = [&](const char* attribute, std::vector<double>& to) {
    if (!v.has(attribute)) return;
    const std::vector<double> x = v.numbers(attribute, 1, 3);
    if (x[0] < 0) v.fail(v.described() + ": its " + attribute + " is negative");
    if (std::any_of(x.begin() + 1, x.end(), [](double higher) { return higher != 0; }))
      c.notes.count(std::string("ignored: coefficients of higher order of the ") + attribute + " of a joint", where);
    if (x[0] != 0) to.assign(nv, x[0]);
  };
  each("armature", j.armature);
  each("damping", j.damping);
  each("frictionloss", j.friction);
  if (nv == 6 && !j.armature.empty())
    c.notes.count("armature of a free joint, which MuJoCo adds to the accelerations of the world's axes and libdyn to those of the body's", where);
}

}  // namespace

Inertia<long double> readInertial(const Values& v, const SE3<long double>& frame, Inertias inertias, const Context& c) {
  if (!v.has("mass")) v.fail("<inertial> has no attribute 'mass'", ErrorCode::syntax);
  if (!v.has("pos")) v.fail("<inertial> has no attribute 'pos'", ErrorCode::syntax);
  Inertia<long double> Y;
  Y.mass = v.positive("mass", 0);
  const bool full = v.has("fullinertia");
  if (full && v.has("diaginertia")) v.fail("<inertial> has both diaginertia and fullinertia; give one of them");
  if (full) {
    for (const char* turn : {"quat", "axisangle", "xyaxes", "zaxis", "euler"})
      if (v.has(turn)) v.fail(std::string("<inertial> has both fullinertia and ") + turn + "; its axes are those of the body");
    const std::vector<double> I = v.numbers("fullinertia", 6, 6);
    Y.rotational = {I[0], I[3], I[4], I[1], I[5], I[2]};
  } else if (v.has("diaginertia")) {
    const std::vector<double> I = v.numbers("diaginertia", 3, 3);
    Y.rotational = {I[0], 0, 0, I[1], 0, I[2]};
  }
  checkPhysical(v, Y, inertias, c);
  return Y.transformed(frame * poseOf(v, c.settings));
}

Inertia<long double> bounded(const Inertia<long double>& Y, const Settings& settings) {
  Inertia<long double> out = Y;
  out.mass = std::max(Y.mass, static_cast<long double>(settings.least_mass));
  if (settings.least_inertia == 0 && !settings.balance_inertia) return out;
  const auto axes = principal(Y.rotational);
  Eigen::Matrix<long double, 3, 1> I = axes.eigenvalues().cwiseMax(static_cast<long double>(settings.least_inertia));
  if (settings.balance_inertia && I.sum() < 2 * I.maxCoeff()) I.setConstant(I.sum() / 3);
  const Matrix M = axes.eigenvectors() * I.asDiagonal() * axes.eigenvectors().transpose();
  out.rotational = {M(0, 0), M(0, 1), M(0, 2), M(1, 1), M(1, 2), M(2, 2)};
  return out;
}

Joint readJoint(const Values& v, const SE3<long double>& frame, const Context& c) {
  Joint out;
  JointDescription& j = out.description;
  const bool freejoint = std::strcmp(v.element().Name(), "freejoint") == 0;
  enum { free, ball, slide, hinge };
  const int type = freejoint ? free : v.word("type", {"free", "ball", "slide", "hinge"}, hinge);
  if (type == free) {
    j.type = "free_flyer";
    out.free = true;
    // The class of a <freejoint> has no influence on it.
    if (!freejoint) readCommon(v, 6, false, false, c, j);
    return out;
  }
  const SE3<long double> anchor{Mat3<long double>::identity(), frame.act(v.vector3("pos"))};
  out.pose = anchor;
  out.after = anchor.inverse();
  if (type == ball) {
    j.type = "spherical";
    readCommon(v, 3, true, false, c, j);
    return out;
  }
  const Vec3<long double> axis = frame.R * axisOf(v);
  const Vec3<long double> unit = (1 / std::sqrt(dot(axis, axis))) * axis;
  j.type = type == hinge ? "revolute" : "prismatic";
  const Vec3<double> rounded = cast<double>(unit);
  j.parameters["axis"] = std::vector<double>{rounded.x, rounded.y, rounded.z};
  const long double ref = type == hinge ? c.settings.angle(v.number("ref", 0)) : v.number("ref", 0);
  out.ref = static_cast<double>(ref);
  if (ref != 0 && type == hinge) out.pose.R = exp3(-ref * unit);
  if (ref != 0 && type == slide) out.pose.p += -ref * unit;
  readCommon(v, 1, false, type == hinge, c, j);
  return out;
}

}  // namespace dyn::mjcf
