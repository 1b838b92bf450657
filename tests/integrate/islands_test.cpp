// SPDX-License-Identifier: BSD-2-Clause
// IslandSimulator simulates each mechanism without contact to others separately, and skips mechanisms at rest.
#include "integrate/problems.hpp"

#include <dyn/compile/edit.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A double pendulum, a damped pendulum, and a ball over the ground.
Model threeThings() {
  Model damped = tool::pendulum(1);
  damped.bodies[1].joint.damping = {4};
  Model out = append(tool::pendulum(2), damped, "universe", {}, "damped/");
  return append(out, tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 9.81), "universe", {}, "ball/");
}

IslandSimulator start(const SleepOptions& sleep, const Scene& scene = {}) {
  CompileOptions options;
  options.scene = scene;
  IslandSimulator s(threeThings(), registry(), options, {.dt = 1e-3}, sleep);
  const auto put = [&](const std::string& joint, const Vector& q, const Vector& v) {
    const int k = s.islandOf(joint);
    if (k >= 0) s.island(k).reset(q, v);
  };
  put("j1", (Vector(2) << 0.5, 0.25).finished(), Vector::Zero(2));
  put("damped/j1", Vector::Constant(1, 1), Vector::Zero(1));
  put("ball/joint", Vector(Eigen::Vector3d(0, 0, 0.5)), Vector::Zero(3));
  const int ball = s.islandOf("ball/joint");
  if (ball >= 0) s.island(ball).setContacts(pointsOnPlane(s.island(ball).model(), {"ball/body"}));
  return s;
}

}  // namespace

TEST_CASE("islands move as they do in the whole scene", "[islands]") {
  IslandSimulator s = start({});
  CHECK(s.count() == 3);
  CHECK(s.report().back() == "islands: 3");
  CHECK(s.islandOf("nothing") == -1);
  s.advance(2);
  const CompactModel whole = compile(threeThings(), registry());
  Simulator all(whole, {.dt = 1e-3});
  all.setContacts(pointsOnPlane(whole, {"ball/body"}));
  const auto idx = [&](const char* joint) { return whole.joints()[static_cast<std::size_t>(whole.jointId(joint))].idx_q; };
  Vector q = neutral(whole);
  q[idx("j1")] = 0.5;
  q[idx("j2")] = 0.25;
  q[idx("damped/j1")] = 1;
  q[idx("ball/joint") + 2] = 0.5;
  all.reset(q, Vector::Zero(whole.nv()));
  all.advance(2);
  // In the whole scene all bodies take first-order steps of 1e-3 s with the contact; as islands only the ball does. So results agree to about 1e-3.
  const Simulator& swinging = s.island(s.islandOf("j1"));
  for (const char* joint : {"j1", "j2"}) {
    const auto alone = swinging.model().joints()[static_cast<std::size_t>(swinging.model().jointId(joint))].idx_q;
    CHECK(std::abs(all.q()[idx(joint)] - swinging.q()[alone]) < 1e-3);
  }
  CHECK(std::abs(all.q()[idx("damped/j1")] - s.island(s.islandOf("damped/j1")).q()[0]) < 1e-3);
  CHECK(std::abs(all.q()[idx("ball/joint") + 2] - s.island(s.islandOf("ball/joint")).q()[2]) < 1e-9);
}

TEST_CASE("what rests falls asleep, costs nothing, and wakes as it was", "[islands]") {
  IslandSimulator s = start({.allowed = true, .speed = 1e-6, .time = 0.5}), awake = start({});
  const int swinging = s.islandOf("j1"), damped = s.islandOf("damped/j1"), ball = s.islandOf("ball/joint");
  s.advance(20);
  awake.advance(20);
  CHECK_FALSE(s.asleep(swinging));
  CHECK(s.asleep(damped));
  CHECK(s.asleep(ball));
  // The moving island moves bit for bit as if no island slept.
  CHECK(s.island(swinging).q() == awake.island(swinging).q());
  // Sleeping islands are where they would be awake, up to the sleep speed times the time.
  CHECK(std::abs(s.island(damped).q()[0] - awake.island(damped).q()[0]) < 1e-6 * 20);
  CHECK(std::abs(s.island(ball).q()[2] - awake.island(ball).q()[2]) < 1e-6 * 20);
  const Vector before = s.island(damped).q();
  s.advance(25);
  CHECK(s.island(damped).q() == before);
  CHECK(s.island(damped).statistics().steps == 0);  // no steps since it fell asleep
  s.wake(damped);
  CHECK_FALSE(s.asleep(damped));
  CHECK(s.island(damped).q() == before);
  CHECK(s.island(damped).time() == 25);
  s.island(damped).setController([](double, const VectorResult&, const VectorResult&, VectorMap tau) { tau[0] = 5; });
  s.advance(30);
  CHECK_FALSE(std::abs(s.island(damped).q()[0]) < 0.1);
  CHECK(s.time() == 30);
}

TEST_CASE("islands come to one time, whatever happens in them", "[islands]") {
  IslandSimulator s = start({});
  const int swinging = s.islandOf("j1");
  int passed = 0;
  s.island(swinging).setEvents({{"late", [](double t, const VectorResult&, const VectorResult&) { return t - 0.05; }}});
  s.advance(0.1);
  for (int k = 0; k < s.count(); ++k) CHECK(s.island(k).time() == 0.1);
  // The last island throws when the others have already arrived. They wait for it.
  s.island(s.count() - 1).setController([&](double t, const VectorResult&, const VectorResult&, const VectorMap&) {
    if (t > 0.15 && passed++ == 0) throw std::runtime_error("a moment");
  });
  CHECK_THROWS_WITH(s.advance(0.2), containing("a moment"));
  CHECK(s.time() == 0.1);
  CHECK(s.island(0).time() == 0.2);
  s.advance(0.18);
  CHECK(s.time() == 0.18);
  CHECK(s.island(0).time() == 0.2);
  CHECK(s.island(s.count() - 1).time() == 0.18);
  s.advance(0.3);
  for (int k = 0; k < s.count(); ++k) CHECK(s.island(k).time() == 0.3);
}

TEST_CASE("nothing falls asleep unasked, or while it only turns back", "[islands]") {
  IslandSimulator unasked = start({});
  unasked.advance(10);
  for (int k = 0; k < unasked.count(); ++k) CHECK_FALSE(unasked.asleep(k));
  // A pendulum is at rest at its turning points, but only for a moment.
  IslandSimulator s = start({.allowed = true, .speed = 0.05, .time = 0.2}, {{"j1"}, {}, true});
  CHECK(s.count() == 1);
  s.advance(10);
  CHECK_FALSE(s.asleep(0));
  CHECK_THROWS_WITH(s.island(1), containing("island 1 of 1"));
  CHECK_THROWS_WITH(s.advance(1), containing("time goes forward"));
}

TEST_CASE("what has touched something before does not fall asleep in the air", "[islands]") {
  // At the top a bouncing ball is slower than the sleep speed for 0.02 s, longer than the sleep time.
  IslandSimulator s(tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 9.81), registry(), {}, {.dt = 1e-3, .restitution = 0.5}, {true, 0.1, 0.015});
  REQUIRE(s.count() == 1);
  Simulator& ball = s.island(0);
  ball.setContacts(pointsOnPlane(ball.model(), {"body"}));
  ball.reset(Vector(Eigen::Vector3d(0, 0, 0.2)), Vector::Zero(3));
  s.advance(0.33);  // the top after the first bounce: 0.2 s down, 0.1 s up
  REQUIRE(ball.statistics().impacts == 1);
  CHECK(!s.asleep(0));
  CHECK(ball.q()[2] > 0.03);
  s.advance(3);
  CHECK(s.asleep(0));
  CHECK(std::abs(ball.q()[2]) < 1e-6);
}
