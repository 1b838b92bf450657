// SPDX-License-Identifier: BSD-2-Clause
// Bodies that fly, slide and roll while they spin. The rotation of their axes must not disturb their paths.
#include "integrate/problems.hpp"

#include <Eigen/Geometry>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double u = 0x1p-53, g = 9.81, radius = 0.1;

/// A ball of 1 kg on a free flyer.
Model ballDescription(double gravity = g) {
  const double I = 0.4 * radius * radius;
  return tool::body("free_flyer", 1, {}, {I, I, I}, gravity);
}

Vector twist(const Eigen::Vector3d& v, const Eigen::Vector3d& w) { return (Vector(6) << v, w).finished(); }

Vector highUp(const CompactModel& model, double z) {
  Vector q = neutral(model);
  q[2] = z;
  return q;
}

Eigen::Vector3d inWorld(const Simulator& s) {
  const Vector q = s.q(), v = s.v();
  return Eigen::Quaterniond(q[6], q[3], q[4], q[5]) * Eigen::Vector3d(v.head<3>());
}

/// A contact at the ball's lowest point, whatever the ball's attitude.
ContactFinder ballOnPlane(const CompactModel& model, double friction) {
  return [frame = model.frameId("body"), friction](const VectorResult& q, std::vector<ContactPoint>& found) {
    const Eigen::Vector3d down = Eigen::Quaterniond(q[6], q[3], q[4], q[5]).conjugate() * Eigen::Vector3d(0, 0, -radius);
    ContactPoint p;
    p.frame = frame;
    p.point = {down.x(), down.y(), down.z()};
    p.normal = {0, 0, 1};
    p.gap = q[2] - radius;
    p.friction = friction;
    found.push_back(p);
  };
}

}  // namespace

TEST_CASE("a spinning projectile keeps its momentum and flies its parabola by Euler's methods and the variational one", "[flight]") {
  const CompactModel model = compile(ballDescription(), registry());
  const Integrator integrator = GENERATE(Integrator::semi_implicit_euler, Integrator::explicit_euler, Integrator::variational);
  const double h = 1e-3, t = 1;
  const Eigen::Vector3d v(10, -2, 5), w(30, -60, 75), down(0, 0, -g);
  Simulator s(model, {.integrator = integrator, .dt = h});
  s.reset(neutral(model), twist(v, w));
  s.advance(t);
  const double rounding = 10 * u * 10 * t / h;
  INFO(infoOf(integrator).name);
  CHECK((inWorld(s) - (v + t * down)).norm() < rounding);
  CHECK((s.v().tail<3>() - w).norm() < 10 * rounding);
  const double late = integrator == Integrator::semi_implicit_euler ? h : integrator == Integrator::explicit_euler ? -h : 0;
  // The variational method moves along a screw in each step. The relative error of its direction is of order (h w)^2.
  const double screw = integrator == Integrator::variational ? 1e-3 : 0;
  CHECK((s.q().head<3>() - (t * v + 0.5 * t * (t + late) * down)).norm() < rounding + screw * t * v.norm());
}

TEST_CASE("a plate that slides and spins goes straight on by Euler's methods", "[flight]") {
  const CompactModel model = compile(tool::body("planar", 1, {}, {0.004, 0.004, 0.004}, g), registry());
  const Integrator integrator = GENERATE(Integrator::semi_implicit_euler, Integrator::explicit_euler);
  Simulator s(model, {.integrator = integrator, .dt = 1e-2});
  s.reset(neutral(model), Vector(Eigen::Vector3d(3, -2, 100)));
  const double before = s.energy();
  s.advance(1);
  CHECK(std::abs(s.energy() - before) < 1e4 * u * before);
  CHECK((s.q().head<2>() - Eigen::Vector2d(3, -2)).norm() < 1e4 * u);
}

TEST_CASE("a ball slides without friction, or rolls, at the speed it had, however fast it turns", "[flight][contact]") {
  const CompactModel model = compile(ballDescription(), registry());
  const Integrator integrator = GENERATE(Integrator::rk4, Integrator::semi_implicit_euler);
  const bool rolls = GENERATE(false, true);
  for (const double dt : {1e-2, 1e-3}) {
    Simulator s(model, {.integrator = integrator, .dt = dt});
    s.setContacts(ballOnPlane(model, rolls ? 0.8 : 0));
    const double speed = rolls ? 10 : 1;
    s.reset(highUp(model, radius), twist({speed, 0, 0}, rolls ? Eigen::Vector3d(0, 100, 0) : Eigen::Vector3d(0, 0, 100)));
    const double before = s.energy();
    s.advance(1);
    INFO(infoOf(integrator).name << ", rolls " << rolls << ", dt " << dt);
    CHECK(s.energy() < (1 + 1e-5) * before);
    // At one radian a step rk4 slows the rotation down and lifts the ball off the ground by its own error.
    if (integrator == Integrator::rk4 && rolls && dt > 1e-3) continue;
    CHECK(s.statistics().contact_steps > static_cast<long>(0.9 / dt));
    // The bounds follow from the solver's tolerance of 1e-9 m/s a step.
    CHECK(std::abs(s.energy() - before) < 1e-5 * before);
    CHECK((s.q().head<3>() - Eigen::Vector3d(speed, 0, radius)).norm() < 1e-5);
    CHECK((inWorld(s) - Eigen::Vector3d(speed, 0, 0)).norm() < 1e-5);
  }
}

TEST_CASE("what slides and spins goes on as before after an event amidst a step, and is seen to", "[flight][contact]") {
  const CompactModel model = compile(ballDescription(), registry());
  Simulator s(model, {.dt = 1e-2});
  s.setContacts(ballOnPlane(model, 0));
  s.setEvents({{"there", [](double, const VectorResult& q, const VectorResult&) { return q[0] - 0.503; }}});
  s.reset(highUp(model, radius), twist({1, 0, 0}, {0, 0, 100}));
  CHECK(s.advance(1) == 0);
  CHECK(std::abs(s.q()[0] - 0.503) < 1e-5);
  CHECK((inWorld(s) - Eigen::Vector3d(1, 0, 0)).norm() < 1e-6);
  const double speed = 1;
  s.advance(1, {0.7, 0.7033}, [&](double t, const VectorResult& q, const VectorResult& v) {
    CHECK(std::abs(q[0] - speed * t) < 1e-6);
    CHECK(std::abs(std::hypot(v[0], v[1]) - speed) < 1e-6);
  });
  CHECK((s.q().head<3>() - Eigen::Vector3d(speed, 0, radius)).norm() < 1e-6);
}

TEST_CASE("the variational method throws a ball as far and as fast as one likes, and from as high up", "[flight][variational]") {
  const CompactModel model = compile(ballDescription(), registry());
  struct Throw {
    double height, speed, spin, dt, time;
  };
  for (const Throw& x : {Throw{100, 10, 10, 1e-3, 1}, Throw{1e5, 10, 10, 1e-3, 0.2}, Throw{0, 10, 0, 1e-2, 3}, Throw{0, 10, 10, 1e-2, 3},
                         Throw{0, 100, 0, 1e-2, 1}, Throw{0, 100, 10, 1e-2, 1}}) {
    INFO("from " << x.height << " m at " << x.speed << " m/s, " << x.spin << " rad/s, dt " << x.dt);
    Simulator s(model, {.integrator = Integrator::variational, .dt = x.dt});
    const Eigen::Vector3d v(x.speed, 0, 0);
    s.reset(highUp(model, x.height), twist(v, {0, 0.6 * x.spin, 0.8 * x.spin}));
    const double before = s.energy();
    s.advance(x.time);
    CHECK((inWorld(s) - (v + x.time * Eigen::Vector3d(0, 0, -g))).norm() < 1e-9 * x.speed);
    CHECK(std::abs(s.energy() - before) < 1e-2 * before);
    CHECK((s.q().head<3>() - highUp(model, x.height).head<3>() - x.time * v - 0.5 * x.time * x.time * Eigen::Vector3d(0, 0, -g)).norm() <
          1e-2 * x.speed * x.time);
  }
}
