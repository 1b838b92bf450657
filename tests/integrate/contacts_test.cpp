// SPDX-License-Identifier: BSD-2-Clause
// Contacts and joint limits in simulations, compared with closed forms for rigid bodies.
#include "integrate/problems.hpp"

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double g = 9.81;

CompactModel ball() { return compile(tool::body("translation", 2, {}, {0.1, 0.1, 0.1}, g), registry()); }

/// A box of 1 x 1 x 0.5 m and 3 kg, with frames at the corners of its lower face.
CompactModel box(std::vector<std::string>& corners) {
  Model model = tool::body("free_flyer", 3, {}, {3 * (1 + 0.25) / 12, 3 * (1 + 0.25) / 12, 3 * 2.0 / 12}, g);
  for (int k = 0; k < 4; ++k) {
    corners.push_back("corner" + std::to_string(k));
    SE3<double> at;
    at.p = {k % 2 ? 0.5 : -0.5, k / 2 ? 0.5 : -0.5, -0.25};
    model.addFrame(corners.back(), 1, at);
  }
  return compile(model, registry());
}

Vector at(const CompactModel& model, std::initializer_list<double> first) {
  Vector q = neutral(model);
  std::copy(first.begin(), first.end(), q.begin());
  return q;
}

/// A pendulum with these joint limits.
CompactModel stopped(double lower, double upper) {
  Model model = tool::pendulum(1);
  model.bodies[1].joint.limits.lower = {lower};
  model.bodies[1].joint.limits.upper = {upper};
  return compile(model, registry());
}

}  // namespace

TEST_CASE("an elastic ball keeps bouncing to where it came from", "[contact]") {
  const CompactModel model = ball();
  const Integrator integrator = GENERATE(Integrator::rk4, Integrator::dormand_prince, Integrator::implicit_midpoint);
  Simulator s(model, {.integrator = integrator, .dt = 1e-2, .restitution = 1});
  s.setContacts(pointsOnPlane(model, {"body"}));
  s.reset(at(model, {0, 0, 1}), Vector::Zero(3));
  const double before = s.energy();
  s.advance(20);
  // The period between bounces is 2 sqrt(2 d / g); the ball starts at the top.
  const double period = 2 * std::sqrt(2 / g);
  const long bounces = static_cast<long>(std::floor(20 / period + 0.5));
  const double since = 20 - (static_cast<double>(bounces) - 0.5) * period, v = std::sqrt(2 * g) - g * since;
  INFO(infoOf(integrator).name);
  CHECK(s.statistics().impacts == bounces);
  CHECK(s.statistics().contact_steps == 0);
  // Each impact at 4.43 m/s is solved to 1e-9 m/s.
  const double wrong = static_cast<double>(bounces) * ContactSettings().tolerance;
  CHECK(std::abs(s.energy() - before) < wrong * 2 * std::sqrt(2 * g));
  CHECK(std::abs(s.q()[2] - (1 - 0.5 * (v / g) * v)) < wrong * 20);
}

TEST_CASE("a ball that loses half its speed at each bounce comes to rest when the series of its bounces ends", "[contact]") {
  const CompactModel model = ball();
  Simulator s(model, {.dt = 1e-3, .restitution = 0.5});
  s.setContacts(pointsOnPlane(model, {"body"}));
  s.reset(at(model, {0, 0, 1}), Vector::Zero(3));
  // The series of bounces ends at the time sqrt(2 d / g) (1 + e) / (1 - e).
  const double end = std::sqrt(2 / g) * 3;
  s.advance(0.9 * end);
  CHECK(s.q()[2] > 1e-4);
  const double bounces_before = static_cast<double>(s.statistics().impacts);
  s.advance(end + 0.01);
  CHECK(static_cast<double>(s.statistics().impacts) > bounces_before);
  CHECK(s.statistics().impacts < 20);
  CHECK(std::abs(s.q()[2]) < 1e-9);
  // The ball is at rest up to the solver's tolerance and the correction of the resulting penetration.
  CHECK(std::abs(s.v()[2]) < 1e-7);
  const double height = s.q()[2];
  s.advance(end + 1);
  CHECK(std::abs(s.q()[2] - height) < 1e-9);
}

TEST_CASE("a box slides down a slope as Coulomb says, or not at all", "[contact]") {
  std::vector<std::string> corners;
  const CompactModel model = box(corners);
  const double slope = 0.3;
  const Vec3<double> normal{std::sin(slope), 0, std::cos(slope)};
  Vector q = neutral(model);
  // The box is tilted with the slope and lies on it with its lower face.
  q[4] = std::sin(slope / 2);
  q[6] = std::cos(slope / 2);
  q.head<3>() = 0.25 * Eigen::Vector3d(normal.x, normal.y, normal.z);
  const auto slid = [&](double friction, double dt) {
    Simulator s(model, {.dt = dt});
    s.setContacts(pointsOnPlane(model, corners, normal, 0, friction));
    s.reset(q, Vector::Zero(6));
    s.advance(1);
    CHECK(s.statistics().contact_steps >= static_cast<long>(0.99 / dt));
    return Eigen::Vector3d(s.q().head<3>() - q.head<3>()).dot(Eigen::Vector3d(normal.z, 0, -normal.x));
  };
  CHECK(std::abs(slid(1.01 * std::tan(slope), 1e-2)) < 1e-6);
  // Semi-implicit steps with constant acceleration give a t (t + dt) / 2, up to the solver's tolerance of 1e-9 m/s a step.
  const double friction = 0.5 * std::tan(slope), a = g * (std::sin(slope) - friction * std::cos(slope)), dt = 1e-2;
  CHECK(std::abs(slid(friction, dt) - 0.5 * a * (1 + dt)) < 1e-6);
}

TEST_CASE("a box that falls on its corners comes to rest on its face", "[contact]") {
  std::vector<std::string> corners;
  const CompactModel model = box(corners);
  Simulator s(model, {.dt = 1e-3, .restitution = 0.3});
  s.setContacts(pointsOnPlane(model, corners, {0, 0, 1}, 0, 0.6));
  Vector v = Vector::Zero(6);
  v[3] = 0.4;
  v[4] = -0.3;
  s.reset(at(model, {0, 0, 0.6, 0.05, -0.02, 0, 1}), v);
  s.advance(3);
  Data data(model);
  forwardKinematics(model, data, s.q());
  for (const std::string& corner : corners) CHECK(std::abs(framePlacement(model, data, model.frameId(corner)).p.z) < 1e-4);
  CHECK(s.v().cwiseAbs().maxCoeff() < 1e-5);
  CHECK(s.statistics().impacts > 3);
}

TEST_CASE("what starts inside of the ground is pushed out, and not thrown", "[contact]") {
  std::vector<std::string> corners;
  const CompactModel model = box(corners);
  Simulator s(model, {.dt = 1e-3});
  s.setContacts(pointsOnPlane(model, corners, {0, 0, 1}, 0, 0.6));
  const double depth = 0.1;
  s.reset(at(model, {0, 0, 0.25 - depth, 0, 0, 0, 1}), Vector::Zero(6));
  for (int k = 1; k <= 100; ++k) {
    s.advance(0.01 * k);
    CHECK(s.v().cwiseAbs().maxCoeff() < 1e-6);
    CHECK(s.q()[2] < 0.25 + 1e-9);
  }
  CHECK(std::abs(s.q()[2] - 0.25) < 1e-8);
}

TEST_CASE("joints bounce off their limits, and rest at them while something pushes", "[contact][limits]") {
  SECTION("elastic") {
    const CompactModel model = stopped(-0.3, 0.2);
    Simulator s(model, {.dt = 1e-3, .limits = true, .restitution = 1});
    s.reset(Vector::Zero(1), Vector::Constant(1, 1.5));
    const double before = s.energy();
    double lowest = 0, highest = 0;
    for (int k = 1; k <= 500; ++k) {
      s.advance(0.01 * k);
      lowest = std::min(lowest, s.q()[0]);
      highest = std::max(highest, s.q()[0]);
    }
    CHECK(s.statistics().impacts > 10);
    // Each impact, at no more than 1.5 rad/s on 1 kg m^2, is solved to 1e-9 rad/s.
    CHECK(std::abs(s.energy() - before) < static_cast<double>(s.statistics().impacts) * ContactSettings().tolerance * 1.5);
    CHECK(lowest > -0.3 - 1e-10);
    CHECK(highest < 0.2 + 1e-10);
    CHECK(highest > 0.15);
  }
  SECTION("pushed") {
    const CompactModel model = stopped(-0.3, 0.2);
    Simulator s(model, {.dt = 1e-3, .limits = true});
    s.setController([](double t, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = t < 1 ? 8 : -8; });
    s.advance(1);
    CHECK(std::abs(s.q()[0] - 0.2) < 1e-9);
    CHECK(std::abs(s.v()[0]) < 1e-9);
    s.advance(1.1);
    CHECK(s.q()[0] < 0.19);
    s.advance(2);
    CHECK(std::abs(s.q()[0] + 0.3) < 1e-9);
    CHECK(std::abs(s.v()[0]) < 1e-9);
    CHECK(s.statistics().touched == 2);
    CHECK(s.statistics().impacts == 0);
  }
  SECTION("within one long step, from both sides") {
    // Without limits the motion v = 2 - 9 t would pass a limit and come back.
    const CompactModel model = stopped(-0.15, 0.15);
    for (const Integrator integrator : {Integrator::dormand_prince, Integrator::gauss6})
      for (const double way : {1.0, -1.0}) {
        INFO(infoOf(integrator).name << ", " << way);
        Simulator s(model, {.integrator = integrator, .dt = 0.45, .limits = true, .restitution = 0.5});
        s.reset(Vector::Zero(1), Vector::Constant(1, 2 * way));
        s.setController([way](double, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = -9 * way; });
        double farthest = 0;
        std::vector<double> times;
        for (int k = 1; k <= 100; ++k) times.push_back(0.0045 * k);
        s.advance(0.45, times, [&](double, const VectorResult& q, const VectorResult&) { farthest = std::max(farthest, way * q[0]); });
        CHECK(s.statistics().touched >= 1);
        CHECK(farthest <= 0.15 + 1e-9);
      }
  }
  SECTION("without being asked they pass them") {
    Simulator s(stopped(-0.3, 0.2), {.dt = 1e-3});
    s.reset(Vector::Zero(1), Vector::Constant(1, 3));
    s.advance(0.2);
    CHECK(s.q()[0] > 0.3);
  }
}

TEST_CASE("a closed loop stays closed while it lies against a limit", "[contact][limits]") {
  Mechanism m = fourBars(1);
  Model description = tool::fourBars(1);
  description.bodies[1].joint.limits.lower = {-1.0};
  description.bodies[1].joint.limits.upper = {1.0};
  const CompactModel model = compile(description, registry());
  Simulator s(model, {.dt = 1e-3, .limits = true});
  s.reset(m.q, m.v);
  s.advance(2);
  // The mechanism fell to the side to which it was pushed.
  CHECK(std::abs(s.q()[m.dof("crank0")] + 1.0) < 1e-6);
  CHECK(s.constraintError() < 1e-10);
  CHECK(s.v().cwiseAbs().maxCoeff() < 1e-6);
}

TEST_CASE("geared joints stop at a limit together", "[contact][limits]") {
  Model description = tool::pendulum(2);
  description.bodies[1].joint.limits.upper = {0.4};
  description.constraints.push_back(coupleJoint("j2", {"mimic", "j1", {{"coefficients", std::vector<double>{0, -0.5}}}}));
  const CompactModel model = compile(description, registry());
  Simulator s(model, {.dt = 1e-3, .limits = true});
  s.setController([](double, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = 60; });
  s.reset(Vector::Zero(2), Vector::Zero(2));
  s.advance(1);
  CHECK(s.statistics().contact_steps > 100);
  CHECK(std::abs(s.q()[0] - 0.4) < 1e-8);
  CHECK(std::abs(s.q()[1] + 0.2) < 1e-8);
}

TEST_CASE("runs with contacts are the same to the last byte, resumed ones too", "[contact]") {
  std::vector<std::string> corners;
  const CompactModel model = box(corners);
  const auto start = [&] {
    Simulator s(model, {.dt = 1e-3, .restitution = 0.3});
    s.setContacts(pointsOnPlane(model, corners, {0, 0, 1}, 0, 0.6));
    return s;
  };
  Simulator whole = start(), half = start(), other = start();
  const Vector q = at(model, {0, 0, 0.6, 0.05, -0.02, 0, 1}), v = Vector::Zero(6);
  whole.reset(q, v);
  half.reset(q, v);
  whole.advance(0.4);
  half.advance(0.4);
  other.resume(half.save());
  whole.advance(1);
  other.advance(1);
  CHECK(whole.save() == other.save());
  CHECK(whole.statistics().impacts > 0);
}

TEST_CASE("what is no contact is refused", "[contact][error]") {
  const CompactModel model = ball();
  CHECK_THROWS_WITH(pointsOnPlane(model, {"foot"}), containing("no frame 'foot'"));
  CHECK_THROWS_WITH(pointsOnPlane(model, {"body"}, {0, 0, 0}), containing("no direction"));
  for (const double friction : {-1.0, std::nan("")})
    CHECK_THROWS_WITH(pointsOnPlane(model, {"body"}, {0, 0, 1}, 0, friction), containing("not negative"));
  CHECK_THROWS_WITH(pointsOnPlane(model, {"body"}, {0, 0, 1}, std::nan("")), containing("height"));
  CHECK_THROWS_WITH(Simulator(model, {.restitution = 1.5}), containing("restitution is 1.5"));
  Simulator s(model, {});
  s.setContacts([](const VectorResult&, std::vector<ContactPoint>& found) {
    ContactPoint wrong;
    wrong.frame = 77;
    wrong.normal = {0, 0, 1};
    wrong.gap = -1;
    found.push_back(wrong);
  });
  CHECK_THROWS_WITH(s.step(), containing("frame 77"));
  s.setContacts([](const VectorResult&, std::vector<ContactPoint>&) { throw std::runtime_error("no sensor"); });
  CHECK_THROWS_WITH(s.step(), containing("no sensor"));
}

TEST_CASE("an empty finder finds nothing", "[contact]") {
  const ContactFinder empty;
  const Vector q = Vector::Zero(7);
  std::vector<ContactPoint> found;
  empty(VectorResult(q.data(), q.size()), found);
  CHECK(found.empty());
  CHECK_FALSE(static_cast<bool>(empty));
  CHECK_FALSE(empty.looksAhead());
}
