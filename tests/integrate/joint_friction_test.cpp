// SPDX-License-Identifier: BSD-2-Clause
// Joints with Coulomb friction stop, stay at rest, and start again when the force exceeds the friction.
#include "integrate/problems.hpp"
#include "support/random_model.hpp"

#include <dyn/parsers/urdf.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A body of 1 kg that translates, with these friction forces along the axes.
CompactModel slider(const std::vector<double>& friction, double gravity = 0) {
  Model model = tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, gravity);
  model.bodies[1].joint.friction = friction;
  return compile(model, registry());
}

CompactModel rubbingPendulum(int links, double friction) {
  Model model = tool::pendulum(links);
  model.bodies.back().joint.friction = {friction};
  return compile(model, registry());
}

Vector along(double x, double y = 0, double z = 0) { return Vector(Eigen::Vector3d(x, y, z)); }

Controller push(double x) {
  return [x](double, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = x; };
}

}  // namespace

TEST_CASE("a joint with friction comes to rest where it should, and stays there, by every method", "[joint_friction]") {
  const CompactModel model = slider({0.5, 0, 0});
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(model, {.integrator = info.integrator, .dt = 1e-3});
    s.reset(Vector::Zero(3), along(0.01, 0.02));
    s.advance(0.5);
    INFO(info.name);
    CHECK(s.v()[0] == 0);
    CHECK(s.v()[1] == 0.02);
    CHECK(std::abs(s.q()[0] - 1e-4) < (info.order == 1 ? 1e-5 : 1e-12));
    const double there = s.q()[0];
    s.advance(1);
    CHECK(s.q()[0] == there);
  }
}

TEST_CASE("a joint at rest moves when it is pushed harder than its friction", "[joint_friction]") {
  const CompactModel model = slider({0.5, 0.1, 0});
  for (const IntegratorInfo& info : integrators()) {
    Simulator weak(model, {.integrator = info.integrator, .dt = 1e-3}), strong(model, {.integrator = info.integrator, .dt = 1e-3});
    weak.setController(push(-0.4));
    strong.setController(push(-0.6));
    weak.advance(1);
    strong.advance(1);
    INFO(info.name);
    CHECK(weak.q().norm() == 0);
    CHECK(std::abs(weak.acceleration()[0]) < 1e-12);
    CHECK(std::abs(strong.q()[0] + 0.05) < (info.order == 1 ? 1e-4 : 1e-10));
    CHECK(std::abs(strong.acceleration()[0] + 0.1) < 1e-9);
    // The force grows from zero. Friction holds the joint until the force exceeds its limit, then the rest accelerates the joint.
    Simulator grows(model, {.integrator = info.integrator, .dt = 1e-3});
    grows.setController([](double t, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = t; });
    grows.advance(1.5);
    CHECK(std::abs(grows.q()[0] - 1.0 / 6) < 2e-3);
  }
}

TEST_CASE("what friction takes is its force times the way", "[joint_friction]") {
  const CompactModel model = rubbingPendulum(1, 1.5);
  for (const Integrator integrator : {Integrator::rk4, Integrator::dormand_prince, Integrator::gauss6, Integrator::radau5}) {
    Simulator s(model, {.integrator = integrator, .dt = 1e-2, .tolerance = 1e-10});
    s.reset(Vector::Constant(1, 1), Vector::Zero(1));
    const double before = s.energy();
    double way = 0;
    while (s.time() < 6) {
      const double from = s.q()[0];
      s.step();
      way += std::abs(s.q()[0] - from);
      CHECK(std::abs(before - s.energy() - 1.5 * way) < 1e-6);
    }
    INFO(infoOf(integrator).name);
    CHECK(way > 2);
    CHECK(s.v()[0] == 0);
  }
}

TEST_CASE("that a joint comes to rest is an event that happens once", "[joint_friction][event]") {
  const CompactModel model = rubbingPendulum(1, 1);
  for (const IntegratorInfo& info : integrators()) {
    if (info.order == 1) continue;
    Simulator s(model, {.integrator = info.integrator, .dt = 1e-2});
    s.reset(Vector::Constant(1, 1), Vector::Zero(1));
    s.setEvents({{"rests", [](double, const VectorResult&, const VectorResult& v) { return v[0]; }},
                 {"hangs", [](double, const VectorResult& q, const VectorResult&) { return q[0]; }}});
    std::vector<int> found;
    do {
      found.push_back(s.advance(6));
      if (found.back() == 0) CHECK(s.v()[0] == 0);
    } while (s.time() < 6);
    INFO(info.name);
    // After the last swing the pendulum stops before it comes back to where it hangs.
    CHECK(found == std::vector<int>{1, 0, 1, 0, 1, 0, 1, 0, 0, -1});
  }
}

TEST_CASE("a joint that friction holds moves with its neighbours as if it were locked", "[joint_friction]") {
  const CompactModel held = rubbingPendulum(2, 1000), free = compile(tool::pendulum(2), registry());
  const Vector q = (Vector(2) << 1, 0.5).finished();
  Simulator locked(ConstraintSet(free, {lockJoint("j2", {0.5})}), {.integrator = Integrator::gauss6, .dt = 1e-3});
  locked.reset(q, Vector::Zero(2));
  locked.advance(1);
  for (const Integrator integrator : {Integrator::rk4, Integrator::gauss6, Integrator::implicit_midpoint, Integrator::variational}) {
    const auto off = [&](double dt) {
      Simulator s(held, {.integrator = integrator, .dt = dt});
      s.reset(q, Vector::Zero(2));
      s.advance(1);
      CHECK(s.v()[1] == 0);
      return (s.q() - locked.q()).cwiseAbs().maxCoeff();
    };
    const double coarse = off(0x1p-6), fine = off(0x1p-7);
    INFO(infoOf(integrator).name << ": " << coarse << ", " << fine);
    CHECK(fine < 1e-3);
    CHECK(std::log2(coarse / fine) > 1.8);
  }
}

TEST_CASE("friction of a joint that follows another acts on that one by its ratio", "[joint_friction]") {
  Model description = tool::pendulum(2);
  description.gravity = {};
  description.bodies[2].joint.friction = {0.5};
  description.bodies[2].joint.coupling = {"mimic", "j1", {{"coefficients", std::vector<double>{0, -2}}}};
  const CompactModel model = compile(description, registry());
  REQUIRE(model.nv() == 1);
  Simulator weak(model, {}), strong(model, {});
  weak.setController(push(0.99));
  strong.setController(push(1.01));
  weak.advance(0.1);
  strong.advance(0.1);
  CHECK(weak.v()[0] == 0);
  CHECK(strong.v()[0] > 0);
}

TEST_CASE("joints with friction rest while something touches, and slide on it", "[joint_friction][contact]") {
  const CompactModel model = slider({0.5, 0, 0.2}, 9.81);
  Simulator s(model, {.dt = 1e-3, .restitution = 0.3});
  s.setContacts(pointsOnPlane(model, {"body"}));
  s.reset(along(0, 0, 0.2), along(0.5, 0.25, 0));
  s.advance(2);
  CHECK(s.statistics().impacts > 2);
  CHECK(s.statistics().contact_steps > 1000);
  CHECK(std::abs(s.q()[0] - 0.25) < 5e-4);
  CHECK(std::abs(s.q()[1] - 0.5) < 1e-6);
  CHECK(std::abs(s.q()[2]) < 1e-8);
  CHECK(s.v()[0] == 0);
  const double there = s.q()[0];
  s.advance(3);
  CHECK(s.q()[0] == there);
  // Friction holds this body above the ground.
  const CompactModel clamped = slider({0, 0, 9.9}, 9.81);
  Simulator hangs(clamped, {.limits = true});
  hangs.setContacts(pointsOnPlane(clamped, {"body"}));
  hangs.reset(along(0, 0, 0.1), along(0, 0, 0));
  hangs.advance(1);
  CHECK(hangs.q()[2] == 0.1);
}

TEST_CASE("a robot whose joints have friction falls, by every method", "[joint_friction]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  Vector slow;
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(model, {.integrator = info.integrator, .dt = 1e-3});
    INFO(info.name);
    s.setController([&](double t, const VectorResult&, const VectorResult& v, VectorMap tau) {
      for (Eigen::Index k = 6; k < v.size(); ++k) tau[k] = std::sin(20 * t + static_cast<double>(k));
    });
    s.advance(0.1);
    CHECK(s.statistics().inexact_contacts == 0);
    if (slow.size() == 0) slow = s.q();
    CHECK(distance(model, slow, s.q()) < 2e-2);
  }
}

TEST_CASE("a robot whose joints have friction lies on the ground until nothing moves", "[joint_friction][contact]") {
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", {.root = "free_flyer"}), registry());
  Simulator s(model, {.dt = 1e-3, .limits = true});
  s.setContacts(pointsOnPlane(model, {"left_foot", "right_foot", "head", "torso", "left_forearm", "right_forearm"}, {0, 0, 1}, -1, 0.8));
  s.advance(6);
  // The weight of 40 kg and friction of 0.05 N m act together, but the solver still reaches its tolerance.
  CHECK(s.statistics().inexact_contacts < 10);
  // The tolerance of the forces must not let a joint slip now and then.
  double fastest = 0;
  for (int k = 0; k < 1000; ++k) {
    s.step();
    fastest = std::max(fastest, s.v().tail(model.nv() - 6).cwiseAbs().maxCoeff());
  }
  CHECK(fastest == 0);
  CHECK(s.v().head(6).cwiseAbs().maxCoeff() < 1e-8);
}

TEST_CASE("a robot that friction holds stays where it has come to rest, by every method", "[joint_friction]") {
  Model description = randomTree(groups(), 12, 3);
  const CompactModel plain = compile(description, groups());
  for (BodyDescription& body : description.bodies) {
    const int id = plain.findJoint(body.joint.name);
    if (id > 0) body.joint.friction.assign(static_cast<std::size_t>(plain.joints()[static_cast<std::size_t>(id)].nv), 1000);
  }
  const CompactModel model = compile(description, groups());
  Random random(3);
  const Vector q = integrate(model, neutral(model), random.vector(model.nv(), 0.5)), v = random.vector(model.nv(), 0.5);
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(model, {.integrator = info.integrator, .dt = 1e-3});
    s.reset(q, v);
    s.advance(0.1);
    INFO(info.name);
    CHECK(s.v().cwiseAbs().maxCoeff() == 0);
    const Vector there = s.q();
    s.advance(0.3);
    CHECK(distance(model, there, s.q()) < 1e-12);
  }
}

TEST_CASE("a closed loop with friction comes to rest", "[joint_friction][loops]") {
  const Mechanism m = fourBars(1);
  Model description = tool::fourBars(1);
  for (std::size_t k = 1; k < description.bodies.size(); ++k) description.bodies[k].joint.friction = {2};
  const CompactModel model = compile(description, registry());
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(model, {.integrator = info.integrator, .dt = 1e-3});
    s.reset(m.q, m.v);
    s.advance(8);
    INFO(info.name);
    CHECK(s.v().cwiseAbs().maxCoeff() == 0);
    CHECK(s.constraintError() < 1e-12);
    CHECK(s.statistics().steps < 9000);
  }
}

TEST_CASE("runs with friction are the same to the last byte, resumed ones too", "[joint_friction]") {
  const CompactModel model = rubbingPendulum(2, 1);
  for (const IntegratorInfo& info : integrators()) {
    Simulator whole(model, {.integrator = info.integrator, .dt = 1e-3}), other(model, {.integrator = info.integrator, .dt = 1e-3});
    whole.reset((Vector(2) << 1, 0.5).finished(), Vector::Zero(2));
    whole.advance(0.4);
    other.resume(whole.save());
    whole.advance(1);
    other.advance(1);
    INFO(info.name);
    CHECK(whole.save() == other.save());
  }
}

TEST_CASE("a joint that stops and turns back within one step stops", "[joint_friction]") {
  // A force of -4 + 8 t N acts on 2 kg against friction of 3 N. The body stops, rests until the force is 3 N, and moves on.
  const CompactModel model = compile(
      [] {
        Model m = tool::body("translation", 2, {}, {0.1, 0.1, 0.1}, 0);
        m.bodies[1].joint.friction = {0, 3, 0};
        return m;
      }(),
      registry());
  // v = 1.2 - 3.5 t + 2 t^2 is zero at t1.
  const double t1 = (3.5 - std::sqrt(3.5 * 3.5 - 4 * 2 * 1.2)) / 4, s = 1.5 - 7.0 / 8;
  const double where = 1.2 * t1 - 1.75 * t1 * t1 + 2 * t1 * t1 * t1 / 3 + 2 * s * s * s / 3;
  for (const Integrator integrator : {Integrator::dormand_prince, Integrator::rk4, Integrator::gauss6})
    for (const double dt : {0.002, 0.05}) {
      INFO(infoOf(integrator).name << ", " << dt);
      Simulator x(model, {.integrator = integrator, .dt = dt});
      x.reset(Vector::Zero(3), along(0, 1.2));
      x.setController([](double t, const VectorResult&, const VectorResult&, VectorMap tau) { tau[1] = -4 + 8 * t; });
      x.advance(1.5);
      CHECK(std::abs(x.q()[1] - where) < 3 * dt * dt);
    }
}
