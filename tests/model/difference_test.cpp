// SPDX-License-Identifier: BSD-2-Clause
// differences() finds each change of a description, and no other.
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/model/difference.hpp>

#include <algorithm>
#include <functional>

using namespace dyn;
using namespace dyn::test;

namespace {

/// The differences after one change, as lines "topic name what".
std::vector<std::string> after(Model model, const std::function<void(Model&)>& change) {
  Model changed = model;
  change(changed);
  std::vector<std::string> out;
  for (const Difference& d : differences(model, changed)) out.push_back(d.topic + " " + d.name + " " + d.what);
  return out;
}

using Lines = std::vector<std::string>;

Model arm() {
  Model model;
  model.name = "arm";
  JointDescription j{.name = "hinge", .type = "revolute", .parameters = {{"axis", std::vector<double>{0, 0, 1}}}};
  j.limits = {.lower = {-1}, .upper = {1}, .velocity = {2}};
  j.damping = {0.5};
  model.addBody("rod", 0, j, {2, {0, 0, 0.5}, {1, 0, 0, 1, 0, 1}});
  j.name = "slide";
  j.type = "prismatic";
  model.addBody("hand", 1, j, {1, {}, {0.1, 0, 0, 0.1, 0, 0.1}});
  model.addFrame("tip", 2, {});
  model.addGeometry("ball", 2, {}, geometry::Sphere{0.5});
  model.constraints = {closeLoop("loop", "hand", "universe")};
  model.groups = {{.name = "all", .joints = {"hinge"}}};
  model.configurations = {{.name = "home", .joints = {{"hinge", {0.5}, {}}}}};
  return model;
}

}  // namespace

TEST_CASE("a model does not differ from itself, nor from one in another order", "[difference]") {
  CHECK(differences(arm(), arm(), 0).empty());
  for (unsigned seed = 0; seed < 10; ++seed) {
    const Model model = randomTree(registry(), 12, seed, true);
    CHECK(differences(model, model, 0).empty());
  }
  Model first, second;
  const JointDescription a{.name = "ja"}, b{.name = "jb"};
  first.addBody("a", 0, a);
  first.addBody("b", 0, b);
  second.addBody("b", 0, b);
  second.addBody("a", 0, a);
  CHECK(differences(first, second, 0).empty());
}

TEST_CASE("each change is one difference, under its topic and name", "[difference]") {
  CHECK(after(arm(), [](Model& m) { m.name = "leg"; }) == Lines{"model arm name"});
  CHECK(after(arm(), [](Model& m) { m.gravity.z = -1.6; }) == Lines{"model arm gravity [m/s^2]"});
  CHECK(after(arm(), [](Model& m) { m.bodies[2].parent = 0; }) == Lines{"structure hand parent"});
  CHECK(after(arm(), [](Model& m) { m.bodies[2].joint.name = "rail"; }) == Lines{"structure hand joint's name"});
  CHECK(after(arm(), [](Model& m) { m.bodies[2].joint.type = "revolute"; }) == Lines{"joint slide type"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.parameters["axis"] = std::vector<double>{0, 1, 0}; }) == Lines{"joint hinge axis"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.parameters["mode"] = std::string("fast"); }) == Lines{"joint hinge mode"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.placement.p.x = 1e-3; }) == Lines{"placement hinge position [m]"});
  CHECK(after(arm(), [](Model& m) {
          m.bodies[1].joint.placement.R = exp3(Vec3<double>{0, 0, 1e-3});
        }) == Lines{"placement hinge rotation vector [rad]"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.limits.upper = {2}; }) == Lines{"limits hinge upper"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.limits.jerk = {2}; }) == Lines{"limits hinge jerk"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.damping = {}; }) == Lines{"dissipation hinge damping"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].joint.armature = {1}; }) == Lines{"inertia hinge armature"});
  CHECK(after(arm(), [](Model& m) {
          m.bodies[2].joint.coupling = {"mimic", "hinge", {}};
        }) == Lines{"coupling slide coupling's type", "coupling slide master"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].inertia.mass = 3; }) == Lines{"inertia rod mass [kg]"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].inertia.com.x = 1e-3; }) == Lines{"inertia rod centre of mass [m]"});
  CHECK(after(arm(), [](Model& m) { m.bodies[1].inertia.rotational.xy = 1e-3; }) == Lines{"inertia rod xx xy xz yy yz zz [kg m^2]"});
  CHECK(after(arm(), [](Model& m) { m.frames[0].body = 1; }) == Lines{"frame tip body"});
  CHECK(after(arm(), [](Model& m) { m.frames.clear(); }) == Lines{"frame tip frame"});
  CHECK(after(arm(), [](Model& m) { m.geometries[0].shape = geometry::Sphere{0.6}; }) == Lines{"volume ball sizes of the sphere"});
  CHECK(after(arm(), [](Model& m) { m.geometries[0].shape = geometry::Box{{1, 1, 1}}; }) == Lines{"volume ball shape"});
  CHECK(after(arm(), [](Model& m) { m.constraints[0].baumgarte.position = 1; }) == Lines{"constraint loop gains"});
  CHECK(after(arm(), [](Model& m) { std::get<FrameConstraint>(m.constraints[0].relation).free[3] = true; }) ==
        Lines{"constraint loop free directions"});
  CHECK(after(arm(), [](Model& m) { m.disabled_collisions = {{"rod", "hand", ""}}; }) == Lines{"collision hand and rod disabled pair"});
  CHECK(after(arm(), [](Model& m) { m.groups[0].joints = {}; }) == Lines{"group all joints"});
  CHECK(after(arm(), [](Model& m) { m.passive_joints = {"slide"}; }) == Lines{"group slide passive joint"});
  CHECK(after(arm(), [](Model& m) { m.configurations[0].joints[0].q = {0.6}; }) == Lines{"state home q of hinge"});
  CHECK(after(arm(), [](Model& m) { m.addBody("tool", 2, {.name = "flange"}); }) == Lines{"structure tool body"});
  CHECK(after(arm(), [](Model& m) { m.bodies.pop_back(), m.frames.clear(), m.geometries.clear(); }) ==
        Lines{"structure hand body", "frame tip frame", "volume ball volume"});
  // Remarks and places in files are not the robot.
  CHECK(after(arm(), [](Model& m) { m.notes = {"odd"}, m.bodies[1].where.line = 7; }).empty());
}

TEST_CASE("numbers differ beyond the tolerance, and missing values mean the usual ones", "[difference]") {
  Model a = arm(), b = a;
  b.bodies[1].inertia.mass *= 1 + 1e-6;
  b.bodies[1].joint.placement.p.x = 1e-6;
  const std::vector<Difference> found = differences(a, b, 1e-7);
  REQUIRE(found.size() == 2);
  CHECK(found[0].unit == "m");
  CHECK(found[0].size == approx(1e-6));
  CHECK(found[1].unit == "1");
  CHECK(found[1].size == approx(1e-6).epsilon(1e-5));
  CHECK(differences(a, b, 1e-5).empty());
  constexpr double infinity = std::numeric_limits<double>::infinity();
  b = a;
  b.bodies[1].joint.limits.effort = {infinity};
  b.bodies[1].joint.friction = {0};
  CHECK(differences(a, b, 0).empty());
  b.bodies[1].joint.limits.upper = {};
  const std::vector<Difference> limit = differences(a, b, 1);
  REQUIRE(limit.size() == 1);
  CHECK(limit[0].b == "-");
  CHECK(std::isinf(limit[0].size));
}

TEST_CASE("models with indices out of range are refused", "[difference]") {
  Model a = arm(), b = a;
  b.bodies[2].parent = 9;
  CHECK_THROWS_WITH(differences(a, b), containing("body 9"));
  b = a;
  b.frames[0].body = -1;
  CHECK_THROWS_WITH(differences(a, b), containing("body -1"));
}
