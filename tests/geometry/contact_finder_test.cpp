// SPDX-License-Identifier: BSD-2-Clause
// Contacts of volumes lie on the solids, and bodies stand, slide, roll and pile up on these contacts as rigid bodies do.
#include "geometry/scene.hpp"

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/centroidal.hpp>
#include <dyn/geometry/contact_finder.hpp>
#include <dyn/integrate/simulator.hpp>

#include <algorithm>
#include <cmath>
#include <map>

using namespace dyn;
using namespace dyn::test;
namespace g = dyn::geometry;

namespace {

using Vector = Eigen::VectorXd;
constexpr double gravity = 9.81;

/// Adds a free body with this shape, mass, principal moments of inertia and position.
int addSolid(Model& model, const std::string& name, const GeometryShape& shape, double mass, const Vec3<double>& moments, const Vec3<double>& at) {
  const int body = model.addBody(name, 0, jointOf(name + "_joint", "free_flyer", {Mat3<double>::identity(), at}),
                                 {mass, {}, {moments.x, 0, 0, moments.y, 0, moments.z}});
  model.addGeometry(name, body, {}, shape);
  return body;
}
int addBox(Model& model, const std::string& name, const Vec3<double>& size, double mass, const Vec3<double>& at) {
  const double x = size.x * size.x, y = size.y * size.y, z = size.z * size.z;
  return addSolid(model, name, g::Box{size}, mass, {mass / 12 * (y + z), mass / 12 * (x + z), mass / 12 * (x + y)}, at);
}
int addBall(Model& model, const std::string& name, double radius, double mass, const Vec3<double>& at) {
  const double moment = 0.4 * mass * radius * radius;
  return addSolid(model, name, g::Sphere{radius}, mass, {moment, moment, moment}, at);
}

Model onFloor(const GeometryShape& floor = g::HalfSpace{}, const Vec3<double>& down = {0, 0, -gravity}) {
  Model model;
  model.gravity = down;
  model.addGeometry("floor", 0, {}, floor);
  return model;
}

struct World {
  CompactModel model;
  Simulator simulator;
  World(const Model& description, const GeometryContactOptions& contacts, const SimulatorOptions& options)
      : model(compile(description, registry())), simulator(model, options) {
    simulator.setContacts(geometryContacts(model, compileGeometry(model, description), contacts));
  }
  Vector velocityOf(const std::string& joint) const {
    const JointRecord& j = model.joints()[static_cast<std::size_t>(model.jointId(joint))];
    return simulator.v().segment(j.idx_v, 6);
  }
};

std::vector<ContactPoint> contactsOf(TwoSolids& s, const SE3<double>& pose, double margin) {
  std::vector<ContactPoint> found;
  const Vector q = configurationOf(pose);
  geometryContacts(s.model, s.geometry, {.margin = margin})(VectorResult(q.data(), q.size()), found);
  return found;
}

}  // namespace

TEST_CASE("contacts of any two solids lie on them, and the nearest of them are their distance apart", "[contact][property]") {
  Random random(7);
  for (int k = 0; k < 2000; ++k) {
    const GeometryShape a = random.below(5) == 0 ? GeometryShape(g::HalfSpace{}) : someShape(random, 1), b = someShape(random, 1);
    const bool plane = std::holds_alternative<g::HalfSpace>(a);
    TwoSolids s(a, {}, b);
    SE3<double> pose = random.pose();
    pose.p = 3.0 * pose.p;
    // Moves b so that the two are at most a centimetre apart or overlap by as much.
    const Distance before = s.distance(pose);
    const double wanted = random.uniform(-0.01, 0.01);
    if (before.distance < 0) continue;
    pose.p -= (before.distance - wanted) * before.normal;
    const Distance now = s.distance(pose);
    const std::vector<ContactPoint> found = contactsOf(s, pose, 0.02);
    REQUIRE(!found.empty());
    double lowest = HUGE_VAL;
    for (const ContactPoint& c : found) {
      lowest = std::min(lowest, c.gap);
      // b moves, so the contact point is on b and the contact surface is a's.
      CHECK(c.frame != 0);
      CHECK(c.other == 0);
      CHECK(std::abs(dot(c.normal, c.normal) - 1) < 1e-12);
      // The contact point is on b's surface; a's surface is `gap` away from it along the normal.
      TwoSolids point(b, {}, g::Sphere{0});
      const double on_b = point.distance({Mat3<double>::identity(), c.point}).distance;
      TwoSolids surface(a, {}, g::Sphere{0});
      const double on_a = surface.distance({Mat3<double>::identity(), pose.act(c.point) - c.gap * c.normal}).distance;
      INFO(k << " shapes " << a.index() << " " << b.index() << " of " << found.size() << " gap " << c.gap << " distance " << now.distance);
      // The curved sides of tilted round solids are approximated by chords, which lie inside the solid. So a point on a chord may be as deep inside b
      // as its gap exceeds the distance.
      CHECK(on_b < 2e-3);
      CHECK(-on_b < std::max(2e-3, c.gap - now.distance));
      CHECK(on_a < (plane ? 1e-12 : 2e-3));
    }
    INFO(k << " shapes " << a.index() << " " << b.index());
    CHECK(std::abs(lowest - now.distance) < 1e-9);
  }
}

TEST_CASE("what lies on a face touches at the corners of what the two share", "[contact]") {
  const auto corners = [](TwoSolids& s, const SE3<double>& pose) {
    std::vector<Vec3<double>> out;
    for (const ContactPoint& c : contactsOf(s, pose, 0.01)) out.push_back(pose.act(c.point));
    return out;
  };
  const auto has = [](const std::vector<Vec3<double>>& all, double x, double y) {
    return std::any_of(all.begin(), all.end(), [&](const Vec3<double>& p) { return std::hypot(p.x - x, p.y - y) < 1e-9; });
  };
  SECTION("a box hanging over the edge of another") {
    TwoSolids s(g::Box{{2, 2, 2}}, {}, g::Box{{1, 1, 1}});
    const auto found = corners(s, {Mat3<double>::identity(), {0.8, 0, 1.5}});
    CHECK(found.size() == 4);
    for (const double x : {0.3, 1.0})
      for (const double y : {-0.5, 0.5}) CHECK(has(found, x, y));
  }
  SECTION("a beam across another") {
    TwoSolids s(g::Box{{4, 0.2, 0.2}}, {}, g::Box{{0.2, 4, 0.2}});
    const auto found = corners(s, {Mat3<double>::identity(), {0.5, 0.3, 0.2}});
    CHECK(found.size() == 4);
    for (const double x : {0.4, 0.6})
      for (const double y : {-0.1, 0.1}) CHECK(has(found, x, y));
  }
  SECTION("a capsule along a box, a cylinder on a plane, a triangle mesh on a field of heights") {
    TwoSolids capsule(g::Box{{1, 1, 1}}, {}, g::Capsule{0.1, 3});
    const auto lying = corners(capsule, {{{0, 0, 1, 0, 1, 0, -1, 0, 0}}, {0, 0.2, 0.6}});
    CHECK(lying.size() == 2);
    CHECK((has(lying, 0.5, 0.2) && has(lying, -0.5, 0.2)));
    TwoSolids cylinder(g::HalfSpace{}, {}, g::Cylinder{0.5, 1});
    CHECK(corners(cylinder, {Mat3<double>::identity(), {0, 0, 0.5}}).size() == 8);
    g::TriangleMesh field = heightField(9, 9, std::vector<double>(81, 0.0), -2, -2, 0.5, 0.5);
    TwoSolids box(field, {}, g::Box{{0.9, 0.9, 0.2}});
    const auto found = corners(box, {Mat3<double>::identity(), {0.1, 0.2, 0.101}});
    CHECK(found.size() == 8);
    for (const double x : {-0.35, 0.55})
      for (const double y : {-0.25, 0.65}) CHECK(has(found, x, y));
  }
}

TEST_CASE("a contact keeps its number as long as it keeps its place", "[contact][property]") {
  Random random(3);
  std::vector<double> heights(121);
  for (double& h : heights) h = random.uniform(-0.02, 0.02);
  const g::TriangleMesh field = heightField(11, 11, heights, -2, -2, 0.4, 0.4);
  std::size_t all = 0, kept = 0;
  for (int k = 0; k < 600; ++k) {
    const GeometryShape below = k % 3 == 0 ? GeometryShape(field) : k % 3 == 1 ? GeometryShape(g::HalfSpace{}) : GeometryShape(g::Box{{4, 4, 1}});
    TwoSolids s(below, {}, someShape(random, 1.5));
    SE3<double> pose = random.pose();
    // The solid lies nearly on a side, so that small motions change which end is lower.
    const auto quarters = [&] { return M_PI / 2 * random.below(4); };
    if (k % 2 == 1) pose.R = exp3(random.vector(1e-3)) * exp3(Vec3<double>{quarters(), 0, 0}) * exp3(Vec3<double>{0, quarters(), 0});
    pose.p = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 2};
    pose.p -= (s.distance(pose).distance - 0.01) * Vec3<double>{0, 0, 1};
    const auto byNumber = [&](const SE3<double>& at) {
      std::map<std::int64_t, Vec3<double>> out;
      for (const ContactPoint& c : contactsOf(s, at, 0.05)) CHECK(out.emplace(c.id, c.point).second);
      return out;
    };
    const auto before = byNumber(pose);
    pose = {pose.R * exp3(random.vector(1e-3)), pose.p + random.vector(1e-3)};
    const auto after = byNumber(pose);
    INFO(k << " shape " << s.description.geometries.back().shape.index());
    for (const auto& [id, point] : before) {
      ++all;
      if (after.count(id) == 0) continue;
      ++kept;
      const Vec3<double> moved = after.at(id) - point;
      CHECK(dot(moved, moved) < 0.6 * 0.6);  // each eighth of a rim has one number
    }
  }
  CHECK(all > 1000);
  CHECK(kept > all / 2);
}

TEST_CASE("a ball rolls down a slope, and slips where friction is too low", "[contact]") {
  const double slope = 0.3;
  const Vec3<double> down{gravity * std::sin(slope), 0, -gravity * std::cos(slope)};
  Model description = onFloor(g::HalfSpace{}, down);
  addBall(description, "ball", 0.2, 3, {0, 0, 0.2});
  const auto speed = [&](double friction, double dt) {
    World s(description, {.friction = friction}, {.dt = dt});
    s.simulator.advance(1);
    return s.simulator.v().head<3>().norm();
  };
  const double rolling = 5.0 / 7 * gravity * std::sin(slope), slipping = gravity * (std::sin(slope) - 0.05 * std::cos(slope));
  // Forces are constant, and velocities do not rotate with the ball's axes, so only the contact solver's error remains.
  CHECK(std::abs(speed(0.3, 1e-2) - rolling) < 1e-6 * rolling);
  // Rolling needs a friction coefficient of at least 2/7 tan(slope).
  CHECK(std::abs(speed(0.05, 1e-2) - slipping) < 0.01 * slipping);
  CHECK(std::abs(speed(0.05, 2.5e-3) - slipping) < 0.5 * std::abs(speed(0.05, 1e-2) - slipping));
}

TEST_CASE("a box pushed from under balls that lie on it: SimBenchmark's rolling", "[contact]") {
  constexpr int side = 5, n = side * side;
  constexpr double box_mass = 10, ball_mass = 1, push = 150, below = 0.4;
  Model description = onFloor();
  const int box = addBox(description, "box", {20, 20, 1}, box_mass, {0, 0, 0.5});
  std::vector<PairFriction> friction{{{"floor", "box"}, below}};
  for (int k = 0; k < n; ++k) {
    const std::string name = "ball" + std::to_string(k);
    const int row = k / side - 2, column = k % side - 2;
    addBall(description, name, 0.5, ball_mass, {2.0 * column, 2.0 * row, 1.5});
    friction.push_back({{"box", name}, 0.8});
  }
  // J. Hwangbo, D. Kang, SimBenchmark: friction with the ground is mu (M + n m) g, and each ball rolls backwards on the box.
  const double f1 = below * (box_mass + n * ball_mass) * gravity;
  const double f2 = (push - f1) / box_mass / (3.5 / ball_mass + n / box_mass);
  const double box_acceleration = (push - f1 - n * f2) / box_mass, ball_acceleration = f2 / ball_mass;
  const auto errors = [&](double dt) {
    World s(description, {.friction = 0.8, .pairs = friction}, {.dt = dt});
    s.simulator.setForces([box](double, const VectorResult&, const VectorResult&, Force<double>* f, int) { f[box].linear = {push, 0, 0}; });
    s.simulator.advance(0.5);
    Eigen::Vector4d out;
    out[0] = s.velocityOf("box_joint")[0] - 0.5 * box_acceleration;
    int k = 1;
    for (const char* name : {"ball0_joint", "ball12_joint", "ball24_joint"}) out[k++] = s.velocityOf(name).head<3>().norm() - 0.5 * ball_acceleration;
    return out;
  };
  CHECK(errors(1e-2).cwiseAbs().maxCoeff() < 1e-6 * 0.5 * box_acceleration);
}

TEST_CASE("boxes dropped on one another become a stack that stands", "[contact]") {
  constexpr int n = 5;
  Model description = onFloor(g::Box{{4, 4, 1}});
  for (int k = 0; k < n; ++k) addBox(description, "box" + std::to_string(k), {1, 1, 0.5}, 2, {0.02 * k, -0.01 * k, 0.75 + 0.52 * k + 0.01});
  World s(description, {.friction = 0.6}, {.dt = 2e-3});
  s.simulator.advance(1);
  const Vector before = s.simulator.q();
  s.simulator.advance(2);
  CHECK(s.simulator.v().cwiseAbs().maxCoeff() < 1e-5);
  CHECK(difference(s.model, before, s.simulator.q()).cwiseAbs().maxCoeff() < 1e-5);
  CHECK(s.simulator.statistics().inexact_contacts < s.simulator.statistics().contact_steps / 100);
  for (int k = 0; k < n; ++k) CHECK(std::abs(s.simulator.q()[7 * k + 2] + 0.75 + 0.52 * k + 0.01 - (0.75 + 0.5 * k)) < 1e-4);
}

TEST_CASE("a box comes to rest on a field of heights", "[contact]") {
  std::vector<double> heights;
  for (int i = 0; i < 11; ++i)
    for (int j = 0; j < 11; ++j) heights.push_back(0.1 * (i - 5));  // rises along x
  Model description = onFloor(heightField(11, 11, heights, -5, -5, 1, 1));
  addBox(description, "box", {1.5, 1, 0.5}, 3, {0, 0, 0.5});
  World s(description, {.friction = 0.6}, {.dt = 2e-3});
  // An edge meets the slope first. The box must not be thrown back as its face comes down.
  s.simulator.advance(0.25);
  CHECK(s.simulator.v()[2] < 0.2);
  s.simulator.advance(2);
  CHECK(s.simulator.v().cwiseAbs().maxCoeff() < 1e-5);
  // The box's lower face lies on the slope of 0.1.
  Data data(s.model);
  forwardKinematics(s.model, data, s.simulator.q());
  const Vec3<double> up = jointPlacement(s.model, data, 1).R * Vec3<double>{0, 0, 1};
  CHECK(std::abs(up.x + 0.1 / std::sqrt(1.01)) < 1e-3);
  CHECK(std::abs(up.y) < 1e-3);
}

TEST_CASE("what falls on uneven ground and rolls there gains no energy", "[contact][property]") {
  constexpr double dt = 2e-3;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    std::vector<double> heights;
    for (int i = 0; i < 21; ++i)
      for (int j = 0; j < 21; ++j) heights.push_back(0.05 * (i - 10) + random.uniform(-0.05, 0.05));
    Model description = onFloor(heightField(21, 21, heights, -10, -10, 1, 1));
    const int body =
        description.addBody("solid", 0, jointOf("joint", "free_flyer", {exp3(random.vector(3)), {0, 0, 1.5}}), {3, {}, {0.4, 0, 0, 0.5, 0, 0.6}});
    description.addGeometry("solid", body, {}, someShape(random, 1.2));
    World s(description, {.friction = 0.6}, {.dt = dt});
    Data data(s.model);
    double before = HUGE_VAL, most = 0;
    for (int k = 1; k * dt < 2; ++k) {
      s.simulator.advance(k * dt);
      const double now =
          computeKineticEnergy(s.model, data, s.simulator.q(), s.simulator.v()) + computePotentialEnergy(s.model, data, s.simulator.q());
      most = std::max(most, now - before);
      before = now;
    }
    INFO("seed " << seed);
    // The solid falls with about 40 J. In one step its energy may grow only by the error of a first-order method.
    CHECK(most < 1);
  }
}

TEST_CASE("options of contacts that make no sense are refused", "[contact][error]") {
  Model description = onFloor();
  addBall(description, "ball", 0.2, 3, {0, 0, 0.2});
  const CompactModel model = compile(description, registry());
  const GeometryModel geometry = compileGeometry(model, description);
  CHECK_THROWS_WITH(geometryContacts(model, geometry, {.friction = -1}), containing("friction is -1"));
  CHECK_THROWS_WITH(geometryContacts(model, geometry, {.margin = NAN}), containing("margin is"));
  CHECK_THROWS_WITH(geometryContacts(model, geometry, {.pairs = {{{"floor", "bal"}, 0.1}}}), containing("no pair is of 'floor' and 'bal'"));
}

TEST_CASE("a ball comes back from its impact whatever its size, its speed and the step", "[contact_finder]") {
  // Lengths are scaled by 2^k and times by 2^(k/2), so the motion is the same. After a fall from 5 m the ball moves farther in one step than the
  // distance at which contacts are reported.
  for (const int k : {0, -24, -9, 7, 30})
    for (const bool plate : {false, true}) {
      CAPTURE(k, plate);
      const double length = std::ldexp(1.0, k), time = std::exp2(0.5 * k), radius = 0.06 * length, height = 5.3 * length;
      Model model = plate ? onFloor(g::Box{{4 * length, 4 * length, 0.002 * length}}) : onFloor();
      if (plate) model.geometries[0].placement.p = {0, 0, -0.001 * length};
      addBall(model, "ball", radius, 2, {0, 0, 0});
      World world(model, {}, {.dt = 2e-3 * time, .restitution = 0.5});
      Vector q = neutral(world.model);
      q[2] = height + radius;
      world.simulator.reset(q, Vector::Zero(6));
      const double fall = std::sqrt(2 * height / gravity);
      world.simulator.advance(1.5 * fall);
      CHECK(world.simulator.statistics().impacts == 1);
      CHECK(std::abs((world.simulator.q()[2] - radius) / height - 0.25) < 2e-3);
      CHECK(std::abs(world.simulator.v()[2]) < 2e-3 * gravity * fall);
    }
}

TEST_CASE("no body passes another unseen", "[contact_finder]") {
  SECTION("a marble and a sheet of metal, by steps of any length") {
    for (const double speed : {3.0, 40.0, 900.0})
      for (const double dt : {1e-4, 3e-3})
        for (const Integrator integrator : {Integrator::rk4, Integrator::semi_implicit_euler, Integrator::dormand_prince}) {
          CAPTURE(speed, dt, infoOf(integrator).name);
          Model model = onFloor(g::Box{{2, 2, 0.0005}}, {});
          addBall(model, "marble", 0.003, 0.01, {0, 0, 0});
          World world(model, {}, {.integrator = integrator, .dt = dt});
          Vector q = neutral(world.model), v = Vector::Zero(6);
          q[2] = 0.7;
          v[2] = -speed;
          world.simulator.reset(q, v);
          world.simulator.advance(2 / speed);
          CHECK(std::abs(world.simulator.q()[2] - 0.00325) < 1e-6);
        }
  }
  SECTION("two that fly against each other") {
    Model model = onFloor(g::HalfSpace{{0, 0, 1}, -100}, {});
    addBall(model, "left", 0.01, 1, {0, 0, 0});
    addBox(model, "right", {0.02, 0.02, 0.02}, 1, {0, 0, 0});
    World world(model, {.friction = 0}, {.dt = 5e-3, .restitution = 1});
    Vector q = neutral(world.model), v = Vector::Zero(12);
    const auto first = [&](const char* joint) { return world.model.joints()[static_cast<std::size_t>(world.model.jointId(joint))]; };
    q[first("left_joint").idx_q] = -3;
    q[first("right_joint").idx_q] = 4;
    v[first("left_joint").idx_v] = 310;
    v[first("right_joint").idx_v] = -170;
    world.simulator.reset(q, v);
    world.simulator.advance(0.1);
    CHECK(std::abs(world.velocityOf("left_joint")[0] + 170) < 1e-6);
    CHECK(std::abs(world.velocityOf("right_joint")[0] - 310) < 1e-6);
  }
  SECTION("a rod that whirls and a thin pole") {
    Model model = onFloor(g::Cylinder{0.002, 1}, {});
    model.geometries[0].placement.p = {0.4, 0, 0};
    addBox(model, "rod", {0.9, 0.01, 0.01}, 1, {0, 0, 0});
    World world(model, {.friction = 0}, {.dt = 4e-3, .restitution = 1});
    Vector q = neutral(world.model), v = Vector::Zero(6);
    q[5] = std::sin(0.5), q[6] = std::cos(0.5);  // rotated by 1 rad about z
    v[5] = -150;
    world.simulator.reset(q, v);
    world.simulator.advance(0.012);
    CHECK(world.simulator.statistics().impacts >= 1);
    CHECK(world.velocityOf("rod_joint")[5] > -149);
    CHECK(world.simulator.energy() == approx(0.5 * (0.81 + 1e-4) / 12 * 150 * 150).epsilon(1e-5));  // one step turns the rod by 0.6 rad
  }
}

TEST_CASE("a stone that comes down again within one step of an adaptive method bounces", "[contact_finder]") {
  Model model = onFloor();
  addBall(model, "stone", 0.05, 1, {0, 0, 0});
  World world(model, {}, {.integrator = Integrator::dormand_prince, .dt = 0.5, .restitution = 1});
  Vector q = neutral(world.model), v = Vector::Zero(6);
  q[2] = 0.05 + 1e-6;
  v[2] = 6;
  world.simulator.reset(q, v);
  const double before = world.simulator.energy();
  world.simulator.advance(5);
  CHECK(world.simulator.statistics().impacts == 4);
  CHECK(world.simulator.energy() == approx(before).epsilon(1e-7));
}

TEST_CASE("floors of several solids are floors, and what stands on them is not stopped at their seams", "[contact_finder]") {
  // A box slides without friction over three slabs side by side, of which the last is rotated.
  for (const double speed : {0.3, 1.7})
    for (const double start : {-0.7, -0.6871, -0.6604}) {
      CAPTURE(speed, start);
      Model model;
      model.gravity = {0, 0, -gravity};
      model.addGeometry("west", 0, {Mat3<double>::identity(), {-1, 0, -0.2}}, g::Box{{1.2, 2, 0.4}});
      model.addGeometry("middle", 0, {Mat3<double>::identity(), {0.1, 0, -0.15}}, g::Box{{1, 2, 0.3}});
      model.addGeometry("east", 0, {Mat3<double>{{0, -1, 0, 1, 0, 0, 0, 0, 1}}, {1.1, 0, -0.1}}, g::Box{{2, 1, 0.2}});
      addBox(model, "box", {0.15, 0.15, 0.1}, 1, {0, 0, 0});
      World world(model, {.friction = 0}, {.dt = 1e-3});
      Vector q = neutral(world.model), v = Vector::Zero(6);
      q[0] = start, q[2] = 0.05;
      v[0] = speed;
      world.simulator.reset(q, v);
      const double time = 1.9 / speed;
      world.simulator.advance(time);
      CHECK(std::abs(world.simulator.q()[0] - (start + 1.9)) < 1e-6);
      CHECK(std::abs(world.simulator.q()[2] - 0.05) < 1e-6);
    }
  // A wall on a floor must still stop the box.
  Model model;
  model.gravity = {0, 0, -gravity};
  model.addGeometry("floor", 0, {Mat3<double>::identity(), {0, 0, -0.2}}, g::Box{{4, 2, 0.4}});
  model.addGeometry("wall", 0, {Mat3<double>::identity(), {1, 0, 0.5}}, g::Box{{0.2, 2, 1}});
  addBox(model, "box", {0.15, 0.15, 0.1}, 1, {0, 0, 0});
  World world(model, {.friction = 0}, {.dt = 1e-3});
  Vector q = neutral(world.model), v = Vector::Zero(6);
  q[2] = 0.05;
  v[0] = 1.3;
  world.simulator.reset(q, v);
  world.simulator.advance(2);
  CHECK(std::abs(world.simulator.q()[0] - (0.9 - 0.075)) < 1e-6);
}

// Pushing bodies apart changes positions at constant joint velocities. This changes the momentum of a moving chain, so chains start at rest here.
TEST_CASE("bodies that overlap from the start are pushed apart without a gain of momentum or energy", "[geometry][contacts]") {
  const auto turned = [](double x, double y, double z) { return exp3(Vec3<double>{x, y, z}); };
  const auto place = [](Model& model, const char* body, const SE3<double>& at) {
    for (BodyDescription& b : model.bodies)
      if (b.name == body) b.joint.placement = at;
  };
  for (const int scene : {0, 1, 2})
    for (const bool moving : {false, true}) {
      if (moving && scene == 1) continue;
      for (const double dt : {1e-2, 1e-3}) {
        Model model;
        model.gravity = {};
        if (scene == 0) {  // rotated boxes of different masses
          addBox(model, "a", {0.3, 0.2, 0.4}, 2, {});
          addBox(model, "b", {0.2, 0.5, 0.1}, 0.3, {});
          addBox(model, "c", {0.2, 0.2, 0.2}, 5, {});
          place(model, "a", {turned(0.3, -0.4, 0.8), {}});
          place(model, "b", {turned(-0.5, 0.2, 0.1), {0.17, 0.02, 0.05}});
          place(model, "c", {turned(0.1, 0.9, -0.3), {-0.1, 0.17, 0.02}});
        } else if (scene == 1) {  // a free chain of two bodies, and a ball that overlaps it
          const int first = addBox(model, "a", {0.4, 0.1, 0.1}, 1, {});
          JointDescription hinge = jointOf("hinge", "revolute", {Mat3<double>::identity(), {0.3, 0, 0}});
          hinge.parameters["axis"] = std::vector<double>{0, 0.6, 0.8};
          const int second = model.addBody("b", first, hinge, {0.6, {0.2, 0, 0}, {1e-3, 0, 0, 9e-3, 0, 9e-3}});
          model.addGeometry("b", second, {Mat3<double>::identity(), {0.2, 0, 0}}, g::Capsule{0.05, 0.3});
          addBall(model, "c", 0.1, 0.4, {0.45, 0.02, 0.09});
        } else {  // a cylinder across two balls
          addSolid(model, "a", g::Cylinder{0.05, 0.8}, 1, {0.054, 0.054, 0.00125}, {});
          addBall(model, "b", 0.1, 3, {0.11, 0.03, 0.3});
          addBall(model, "c", 0.1, 0.5, {-0.12, 0, -0.2});
          place(model, "a", {turned(0.2, 0.1, 0), {}});
        }
        for (const bool friction : {false, true}) {
          World world(model, {.friction = friction ? 0.6 : 0.0}, {.integrator = Integrator::semi_implicit_euler, .dt = dt});
          Vector v = Vector::Zero(world.model.nv());
          if (moving)
            for (Eigen::Index k = 0; k < v.size(); ++k) v[k] = 0.2 * std::sin(1.7 * static_cast<double>(k) + 0.3);
          world.simulator.reset(neutral(world.model), v);
          Data data(world.model, Need::derivatives);
          const auto momentum = [&] { return Eigen::Matrix<double, 6, 1>(ccrba(world.model, data, world.simulator.q(), world.simulator.v()).hg); };
          const Eigen::Matrix<double, 6, 1> before = momentum();
          const double energy = world.simulator.energy();
          INFO("scene " << scene << ", moving " << moving << ", dt " << dt << ", friction " << friction);
          bool touched = false;
          double gained = 0, most = energy;
          while (world.simulator.time() < 0.5) {
            world.simulator.step();
            touched = touched || world.simulator.touches();
            gained = std::max(gained, (momentum() - before).head(moving ? 3 : 6).cwiseAbs().maxCoeff());
            most = std::max(most, world.simulator.energy());
          }
          CHECK(touched);
          CHECK(gained < 1e-12);
          CHECK(most <= energy + 1e-12);
        }
      }
    }
}
