// SPDX-License-Identifier: BSD-2-Clause
// Joints with their own configuration space and a pose map. Functions that the SDK derives are right, and wrong functions of authors are caught.
#include "support/catch.hpp"
#include "support/registry.hpp"

#include <dyn/conformance/conformance.hpp>
#include <dyn/dyn.hpp>
#include <dyn_sdk/joint_plugin.hpp>

#include <Eigen/Dense>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A point on a sphere whose radius is a parameter; q is in R^3 with |q| = radius. Only the pose map and q (+) v are templates, and they have
/// branches. The frame is rotated by the least rotation that takes z to q.
template <class Author>
struct OnSphere : sdk::Joint<Author, 2, 3> {
  static constexpr const char* summary = "for tests";
  static constexpr std::array parameters{ParameterSpec{"radius", ParameterKind::number, true, "m", "of the sphere", "0.7"}};

  template <class S>
  static Mat3<S> axes(const Vec3<S>& n) {
    const S k = S(1) / (S(1) + n.z);
    return {{S(1) - k * n.x * n.x, -(k * n.x * n.y), n.x, -(k * n.x * n.y), S(1) - k * n.y * n.y, n.y, -n.x, -n.y, n.z}};
  }
  template <class S>
  static Vec3<S> unit(const S* q) {
    using std::sqrt;
    const S length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
    return {q[0] / length, q[1] / length, q[2] / length};
  }
  template <class S>
  static SE3<S> pose(const S* q, const sdk::Constants& c) {
    const Vec3<S> n = unit(q);
    return {axes(n), S(c[0]) * n};
  }
  static void neutral(const sdk::Constants& c, double* q) {
    q[0] = q[1] = 0;
    q[2] = c[0];
  }
  template <class S>
  static void integrate(const S* q, const S* v, const sdk::Constants& c, S* out) {
    using std::cos, std::sin, std::sqrt;
    const S angle = sqrt(v[0] * v[0] + v[1] * v[1]), share = angle > S(0) ? S(sin(angle) / angle) : S(1);
    const Vec3<S> n = axes(unit(q)) * Vec3<S>{share * v[0], share * v[1], cos(angle)};
    const S way[3] = {n.x, n.y, n.z};
    const Vec3<S> u = unit(way);
    for (int i = 0; i < 3; ++i) out[i] = S(c[0]) * u[i];
  }
  static void difference(const double* from, const double* to, double* v) {
    const Vec3<double> n = transposeTimes(axes(unit(from)), unit(to));
    const double sine = std::hypot(n.x, n.y), share = sine > 0 ? std::atan2(sine, n.z) / sine : 1;
    v[0] = share * n.x;
    v[1] = share * n.y;
  }
  static double normalize(const sdk::Constants& c, double* q) {
    const Vec3<double> n = unit(q);
    const double distance = std::fabs(std::hypot(q[0], q[1], q[2]) - c[0]);
    for (int i = 0; i < 3; ++i) q[i] = c[0] * n[i];
    return distance;
  }
};
struct Sphere : OnSphere<Sphere> {
  static constexpr const char* name = "sphere";
};
/// A sphere whose dq/dt is wrong, because it assumes radius 1.
struct WrongRates : OnSphere<WrongRates> {
  static constexpr const char* name = "wrong_rates";
  template <class S>
  static void rates(const S* q, const S* v, const sdk::Constants&, S* dq) {
    const Vec3<S> dn = axes(unit(q)) * Vec3<S>{v[0], v[1], S(0)};
    for (int i = 0; i < 3; ++i) dq[i] = dn[i];
  }
};
struct WrongDifference : OnSphere<WrongDifference> {
  static constexpr const char* name = "wrong_difference";
  static void difference(const double* from, const double* to, double* v) {
    v[0] = to[0] - from[0];
    v[1] = to[1] - from[1];
  }
};

/// A crank whose angle is stored as the point (cos, sin) on the unit circle. q (+) v is not a template, so dq/dt and Jacobians are written by hand.
struct Crank : sdk::Joint<Crank, 1, 2> {
  static constexpr const char* name = "crank";
  static constexpr const char* summary = "for tests";
  static constexpr bool branch_free = true;
  template <class S>
  static SE3<S> pose(const S* q, const auto&) {
    using std::sqrt;
    const S length = sqrt(q[0] * q[0] + q[1] * q[1]), c = q[0] / length, s = q[1] / length;
    return {{{c, -s, S(0), s, c, S(0), S(0), S(0), S(1)}}, {S(0), S(0), S(0.3) * s * c}};
  }
  static void neutral(double* q) {
    q[0] = 1;
    q[1] = 0;
  }
  template <class S>
  static void rates(const S* q, const S* v, const auto&, S* dq) {
    dq[0] = -(q[1] * v[0]);
    dq[1] = q[0] * v[0];
  }
  static void integrate(const double* q, const double* v, double* out) {
    const double angle = std::atan2(q[1], q[0]) + v[0];
    out[0] = std::cos(angle);
    out[1] = std::sin(angle);
  }
  static void difference(const double* a, const double* b, double* v) { v[0] = std::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]); }
  static void dIntegrate(const double*, const double*, double* Jq, double* Jv) { Jq[0] = Jv[0] = 1; }
  static double normalize(double* q) {
    const double length = std::hypot(q[0], q[1]);
    q[0] /= length;
    q[1] /= length;
    return std::fabs(length - 1);
  }
};

template <class Author>
std::vector<ConformanceFinding> check(std::uint64_t seed) {
  static const sdk::JointTypeOf<Author> type;
  return checkJointType(type, exampleParameters(type.info(), seed), registry(), seed);
}
bool caughtBy(const std::vector<ConformanceFinding>& findings, const std::string& check) {
  return std::any_of(findings.begin(), findings.end(), [&](const ConformanceFinding& f) { return f.check.rfind(check, 0) == 0 && !f.passed; });
}

/// A point mass at the end of a rod on a joint of type `type`. The rod points along +z, so gravity is along +z, too.
CompactModel pendulum(const std::string& type, const Parameters& parameters, double length, double mass, double gravity) {
  Model model;
  model.gravity = {0, 0, gravity};
  JointDescription joint;
  joint.name = "pivot";
  joint.type = type;
  joint.parameters = parameters;
  model.addBody("bob", 0, joint, {mass, {0, 0, length}, {}});
  return compile(model, registry());
}

}  // namespace

TEST_CASE("a joint whose q is no vector passes the conformance kit with what follows from its q (+) v", "[configuration]") {
  for (std::uint64_t seed = 1; seed <= 6; ++seed)
    for (const auto& findings : {check<Sphere>(seed), check<Crank>(seed)})
      for (const ConformanceFinding& f : findings) {
        INFO("seed " << seed << ", " << f.check << ": " << f.error << " > " << f.bound << ", " << f.detail);
        CHECK(f.passed);
      }
}

TEST_CASE("rates and differences that do not fit q (+) v are caught", "[configuration]") {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    CHECK(caughtBy(check<WrongRates>(seed), "subspace: S is the velocity of the pose (differences)"));
    CHECK(caughtBy(check<WrongDifference>(seed), "(q (+) v) (-) q = v"));
  }
}

TEST_CASE("a conical pendulum on a joint that points goes round once in its period", "[configuration]") {
  const double length = 0.8, mass = 1.7, gravity = 9.5, tilt = 0.6, pi = std::acos(-1.0);
  const double turning = std::sqrt(gravity / (length * std::cos(tilt)));
  const CompactModel model = pendulum("direction", {}, length, mass, gravity);
  Data data(model, Need::mass_matrix);
  const Eigen::Vector3d q(std::sin(tilt), 0, std::cos(tilt));
  const Eigen::MatrixXd M = crba(model, data, q);
  CHECK((M - mass * length * length * Eigen::Matrix2d::Identity()).norm() < 1e-14);
  // The bob moves along y, which is also the y axis of the moved frame, by a negative rotation about the x axis of the moved frame.
  for (const Integrator integrator : {Integrator::rk4, Integrator::gauss6, Integrator::radau5, Integrator::implicit_midpoint}) {
    SimulatorOptions options;
    options.integrator = integrator;
    const int steps = 400;
    options.dt = 2 * pi / turning / steps;
    Simulator simulator(model, options);
    simulator.reset(q, Eigen::Vector2d(-std::sin(tilt) * turning, 0));
    for (int i = 0; i < steps / 4; ++i) simulator.step();
    INFO(static_cast<int>(integrator));
    const double error = integrator == Integrator::implicit_midpoint ? 2e-4 : 1e-8;
    CHECK((simulator.q() - Eigen::Vector3d(0, std::sin(tilt), std::cos(tilt))).norm() < error);
    for (int i = steps / 4; i < steps; ++i) simulator.step();
    CHECK((simulator.q() - q).norm() < 4 * error);
  }
}

TEST_CASE("the variational integrator refuses joints whose space is no group, and says which", "[configuration]") {
  SimulatorOptions options;
  options.integrator = Integrator::variational;
  CHECK_THROWS_WITH(Simulator(pendulum("direction", {}, 1, 1, 9), options), containing("'direction'") && containing("implicit_midpoint"));
}

TEST_CASE("derivatives of an integrated configuration at rest are the identity", "[configuration]") {
  const CompactModel model = pendulum("direction", {}, 1, 1, 9);
  const Eigen::Vector3d q = Eigen::Vector3d(0.3, -0.5, 0.6).normalized();
  for (const ArgumentPosition by : {ArgumentPosition::ARG0, ArgumentPosition::ARG1}) {
    CHECK((dIntegrate(model, q, Eigen::Vector2d::Zero(), by) - Eigen::Matrix2d::Identity()).norm() < 1e-14);
    const double sign = by == ArgumentPosition::ARG0 ? -1 : 1;
    CHECK((dDifference(model, q, q, by) - sign * Eigen::Matrix2d::Identity()).norm() < 1e-14);
  }
}
