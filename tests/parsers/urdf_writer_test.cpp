// SPDX-License-Identifier: BSD-2-Clause
// Models that are written as URDF and read back move in the same way. A report names what URDF cannot say.
#include "support/round_trip.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/srdf.hpp>
#include <dyn/parsers/urdf.hpp>

#include <filesystem>

using namespace dyn;
using namespace dyn::test;

namespace {

Model again(const Model& model, const urdf::Options& options = {.inertias = urdf::Inertias::any}) {
  Model out = urdf::parse(urdf::write(model).text, "again.urdf", options);
  out.gravity = model.gravity;  // URDF has none
  return out;
}

JointDescription hinge(const std::string& name) {
  return {.name = name, .type = "revolute", .parameters = {{"axis", std::vector<double>{0, 0.6, 0.8}}}};
}

const Inertia<double> ball{1, {0.1, 0.2, 0.3}, {1, 0.01, 0.02, 1, 0.03, 1}};

}  // namespace

TEST_CASE("real robots are the same after a round trip through URDF, and lose nothing", "[urdf]") {
  DYN_NEEDS_SHARED();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    INFO(entry.path());
    const Model model = urdf::load(entry.path().string(), {.inertias = urdf::Inertias::any});
    for (const std::string& lost : urdf::write(model).lost) CHECK_THAT(lost, containing("the folder in which relative paths of files begin"));
    const Model read = again(model);
    CHECK_THAT(textOf(differences(model, read, 1e-14)), Catch::Matchers::Equals(""));
    CHECK(checkSameMotion(model, read).empty());
    ++count;
  }
  CHECK(count >= 20);
}

TEST_CASE("robots on a free joint move in the same way after a round trip", "[urdf]") {
  DYN_NEEDS_SHARED();
  const Model model = urdf::load(sharedFolder() + "/models/anymal_c.urdf", {.root = "free_flyer"});
  const urdf::Written written = urdf::write(model);
  CHECK_THAT(joined(written.lost), containing("the world, which becomes a link 'world'"));
  CHECK(checkSameMotion(model, again(model)).empty());
}

TEST_CASE("random trees of all joint types move in the same way after a round trip", "[urdf]") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    INFO(seed);
    Model model = randomTree(registry(), 12, seed, seed % 2 == 0);
    if (seed % 4 == 1) addDependent(model);
    CHECK(checkSameMotion(model, again(model)).empty());
  }
}

TEST_CASE("what URDF has no place for is in the extension, and comes back", "[urdf]") {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Model model;
  model.name = "all";
  model.addBody("base", 0, {.name = "root_joint", .type = "fixed"}, ball);
  JointDescription j = hinge("bounded below");
  j.limits = {.lower = {-1}, .upper = {infinity}, .velocity = {2}, .effort = {3}, .acceleration = {4}, .deceleration = {5}, .jerk = {6}};
  j.armature = {0.1};
  j.placement = {exp3(Vec3<double>{0.3, -1.2, 2.5}), {1, 2, 3}};
  model.addBody("a", 1, j, ball);
  JointDescription fast = hinge("fast");
  fast.limits.velocity = {7};
  fast.damping = {0.5};
  model.addBody("b", 2, fast, ball);
  JointDescription usual = hinge("usual");
  usual.limits = {.lower = {-1}, .upper = {1}, .velocity = {2}, .effort = {3}, .jerk = {4}};
  usual.friction = {0.25};
  model.addBody("c", 3, usual, ball);
  JointDescription follower = hinge("follower");
  follower.coupling = {"mimic", "usual", {{"coefficients", std::vector<double>{0.1, 0.5}}}};
  model.addBody("d", 3, follower, ball);
  JointDescription curved = hinge("curved");
  curved.coupling = {"mimic", "usual", {{"coefficients", std::vector<double>{0.1, 0.5, -0.3}}}};
  model.addBody("e", 3, curved, ball);
  JointDescription plane{.name = "plane", .type = "planar", .parameters = {{"axis", std::vector<double>{0, 1, 0}}}};
  plane.damping = {1, 2, 3};
  model.addBody("f", 1, plane, ball);
  JointDescription series{.name = "series", .type = "composite", .parameters = {{"parts", std::vector<JointDescription>{hinge("x"), hinge("y")}}}};
  series.limits.upper = {1, infinity};
  model.addBody("g", 1, series, ball);
  model.constraints = {closeLoop("loop", "g", "c", {false, true, false, true, false, false}),
                       coupleJoint("fast", {"mimic", "usual", {{"coefficients", std::vector<double>{0, 2}}}})};
  std::get<FrameConstraint>(model.constraints[0].relation).placement.p = {0.1, 0, 0};
  model.constraints[0].baumgarte = {100, 20};
  using namespace geometry;
  const SE3<double> X{exp3(Vec3<double>{0.1, 0.2, 0.3}), {1, 2, 3}};
  for (const GeometryShape& shape :
       {GeometryShape(Sphere{0.1}), GeometryShape(Box{{1, 2, 3}}), GeometryShape(Capsule{1, 2}), GeometryShape(Cylinder{1, 2}),
        GeometryShape(Cone{1, 2}), GeometryShape(HalfSpace{{0, 1, 1}, 0.5}), GeometryShape(OctreeFile{"/c.bt"}),
        GeometryShape(MeshFile{"package://a/b.stl", {1, 2, 3}, true}), GeometryShape(MeshFile{"package://a/b.stl"})})
    model.addGeometry("a_" + std::to_string(model.geometries.size()), 2, X, shape);
  const urdf::Written written = urdf::write(model);
  CHECK(joined(written.lost) == "infinite limits beside finite ones, which become the largest number of 'series'\n");
  const Model read = again(model);
  std::vector<Difference> found = differences(model, read, 1e-14);
  REQUIRE(found.size() == 1);
  CHECK(found[0].name == "series");
  CHECK(found[0].what == "upper");
  CHECK(checkSameMotion(model, read).empty());
  CHECK(urdf::write(model).text == written.text);
}

TEST_CASE("rotations keep their digits where roll and yaw are about one axis", "[urdf]") {
  for (const double pitch : {M_PI / 2, -M_PI / 2, M_PI / 2 - 1e-9, 1.0, 3.0}) {
    INFO(pitch);
    Model model;
    model.addBody("base", 0, {.name = "root_joint", .type = "fixed"});
    JointDescription joint{.name = "j", .type = "fixed"};
    joint.placement.R = exp3(Vec3<double>{0, 0, 0.7}) * exp3(Vec3<double>{0, pitch, 0}) * exp3(Vec3<double>{-2.1, 0, 0});
    model.addBody("a", 1, joint);
    CHECK_THAT(textOf(differences(model, again(model), 2e-15)), Catch::Matchers::Equals(""));
  }
}

TEST_CASE("what URDF cannot say is reported once each, with its first owner", "[urdf]") {
  Model model;
  model.gravity = {0, 0, -1.6};
  JointDescription odd{.name = "odd", .type = "my_type", .parameters = {{"text", std::string("1 2")}, {"damping", std::vector<double>{1}}}};
  model.addBody("a", 0, odd);
  model.addBody("b", 0, hinge("second"));
  model.addFrame("tip", 1, {Mat3<double>::identity(), {0, 0, 1}});
  model.addFrame("end", 2, {});
  model.addGeometry("hull", 1, {}, geometry::ConvexHull{{{1, 2, 3}}});
  model.addGeometry("my ball", 1, {}, geometry::Sphere{1});
  model.constraints = {pointContact("tip"), lockJoint("second")};
  model.disabled_collisions = {{"a", "b", ""}};
  model.groups = {{.name = "arm"}};
  model.configurations = {{.name = "home"}};
  const std::string lost = joined(urdf::write(model).lost);
  for (const char* what :
       {"gravity other than 9.81", "the world, which becomes a link 'world'", "frames, which become links on fixed joints, 2 times, first of 'tip'",
        "texts that look like numbers of 'odd'", "parameters called 'damping'", "names of volumes of 'my ball'",
        "volumes whose points are in the model and not in a file of 'hull'", "constraints between frames that close no loop of 'tip'",
        "locks of joints of 'second'", "pairs without collision checks", "groups (an SRDF has them) of 'arm'", "named states"}) {
    INFO(what);
    CHECK_THAT(lost, containing(what));
  }
  const Model read = urdf::parse(urdf::write(model).text, "again.urdf");
  CHECK(read.findBody("tip") > 0);
  CHECK(read.bodies[static_cast<std::size_t>(read.findBody("b"))].parent == read.findBody("world"));
}

TEST_CASE("models that URDF cannot hold at all are refused", "[urdf]") {
  Model model;
  model.addBody("a", 0, hinge("j"), {std::numeric_limits<double>::quiet_NaN(), {}, {}});
  CHECK_THROWS_WITH(urdf::write(model), containing("value is not finite"));
  model.bodies[1].inertia.mass = 1;
  model.bodies[1].parent = 7;
  CHECK_THROWS_WITH(urdf::write(model), containing("body 7"));
  model.bodies.clear();
  CHECK_THROWS_AS(urdf::write(model), Error);
}
