// SPDX-License-Identifier: BSD-2-Clause
// Models that are written as MJCF and read back move in the same way. A report names what MJCF cannot say.
#include "support/round_trip.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>
#include <dyn/parsers/load.hpp>
#include <dyn/parsers/mjcf.hpp>

#include <filesystem>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Model again(const Model& model) { return mjcf::parse(mjcf::write(model).text, "again.xml", {.inertias = Inertias::any}); }

std::string lostBy(const Model& model) { return joined(mjcf::write(model).lost); }

JointDescription jointOf(const std::string& name, const std::string& type, Parameters parameters = {}) {
  return {.name = name, .type = type, .parameters = std::move(parameters)};
}
JointDescription hinge(const std::string& name, const std::vector<double>& axis = {0, 0.6, 0.8}) {
  return jointOf(name, "revolute", {{"axis", axis}});
}

const Inertia<double> ball{1, {0.1, 0.2, 0.3}, {1, 0.01, 0.02, 1, 0.03, 1}};

/// Types whose coordinates MuJoCo's joints have, too.
const std::vector<std::string> alike{"revolute", "spherical", "prismatic", "universal", "translation", "spherical_zyx", "cylindrical"};

/// Checks that a named state puts all bodies and frames of two models at the same places, with the same velocities.
void checkSameState(const Model& a, const Model& b, const std::string& name) {
  const auto moved = [&](const Model& description, const CompactModel& model, Data& data) {
    Eigen::VectorXd v = Eigen::VectorXd::Zero(model.nv());
    for (const ConfigurationDescription& state : description.configurations)
      if (state.name == name)
        for (const JointState& joint : state.joints) {
          const JointRecord& record = model.joints()[static_cast<std::size_t>(model.jointId(joint.joint))];
          for (std::size_t k = 0; k < joint.v.size(); ++k) v[record.idx_v + static_cast<int>(k)] = joint.v[k];
        }
    forwardKinematics(model, data, namedConfiguration(model, description, name), v);
  };
  const CompactModel first = compile(a, registry()), second = compile(b, registry());
  Data d1(first), d2(second);
  moved(a, first, d1);
  moved(b, second, d2);
  for (std::size_t f = 1; f < first.frames().size(); ++f) {
    INFO(first.frames()[f].name);
    const int i = static_cast<int>(f), own = second.frameId(first.frames()[f].name);
    const SE3<double> X = framePlacement(first, d1, i), Y = framePlacement(second, d2, own);
    CHECK((toEigen(X) - toEigen(Y)).cwiseAbs().maxCoeff() < 1e-13);
    const Motion<double> v = frameVelocity(first, d1, i, ReferenceFrame::LOCAL), w = frameVelocity(second, d2, own, ReferenceFrame::LOCAL);
    CHECK((toEigen(v.linear) - toEigen(w.linear)).norm() < 1e-12);
    CHECK((toEigen(v.angular) - toEigen(w.angular)).norm() < 1e-12);
  }
}

}  // namespace

TEST_CASE("real robots move in the same way after a round trip through MJCF", "[mjcf]") {
  DYN_NEEDS_SHARED();
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sharedFolder() + "/models")) {
    if (entry.path().extension() != ".urdf") continue;
    INFO(entry.path());
    const Model model = load(entry.path().string(), {.mimic = Mimic::independent, .continuous = Continuous::angle, .inertias = Inertias::any});
    const Written written = mjcf::write(model);
    const Model read = mjcf::parse(written.text, "again.xml", {.inertias = Inertias::any});
    std::vector<std::string> missing = checkSameMotion(model, read);
    std::erase(missing, "world");  // MuJoCo's world has this name
    // Only bodies that became joints are missing.
    if (!missing.empty()) CHECK_THAT(joined(written.lost), containing("bodies without mass and volumes, which become joints of the next body"));
    for (const std::string& name : missing) CHECK(model.bodies[static_cast<std::size_t>(model.findBody(name))].inertia.mass == 0);
    // The first time, bodies without mass stay where volumes are on them; if these are lost, the second time takes them for joints.
    const Model second = again(read);
    CHECK_THAT(textOf(differences(second, again(second), 1e-14)), Catch::Matchers::Equals(""));
    ++count;
  }
  CHECK(count >= 20);
}

TEST_CASE("random trees move in the same way after a round trip through MJCF", "[mjcf]") {
  for (unsigned seed = 0; seed < 40; ++seed) {
    INFO(seed);
    Model model = treeOf(registry(), alike, 12, seed);
    model.bodies[1].joint = jointOf("j0", seed % 2 ? "free_flyer" : "fixed");
    model.addFrame("tool", 7, Random(seed).pose());
    const Model read = again(model);
    CHECK(checkSameMotion(model, read).empty());
    CHECK_THAT(textOf(differences(read, again(read), 1e-14)), Catch::Matchers::Equals(""));
  }
}

TEST_CASE("our own models in MJCF are the same after they are written and read", "[mjcf]") {
  for (const char* name : {"arm", "biped", "cart", "four_bar"}) {
    INFO(name);
    const Model model = mjcf::load(std::string(DYN_SOURCE_DIR "/models/") + name + ".xml");
    CHECK(mjcf::write(model).lost.empty());
    CHECK_THAT(textOf(differences(model, again(model), 1e-15)), Catch::Matchers::Equals(""));
  }
}

TEST_CASE("joints with other coordinates are at the same places in keyframes", "[mjcf]") {
  Model model;
  model.name = "all";
  const std::vector<double> axis{0.3, -0.5, 0.8};
  const JointDescription joints[] = {
      jointOf("free", "free_flyer"),
      jointOf("wheel", "continuous", {{"axis", axis}}),
      jointOf("plane", "planar", {{"axis", axis}}),
      jointOf("screw", "helical", {{"axis", axis}, {"pitch", std::vector<double>{0.3}}}),
      jointOf("socket", "spherical"),
      jointOf("loose", "free_flyer"),
      hinge("thumb"),
      hinge("finger", axis),
      jointOf("series", "composite", {{"parts", std::vector<JointDescription>{hinge("x"), jointOf("", "spherical"), hinge("y")}}})};
  Random random(5);
  for (const JointDescription& joint : joints) {
    const int i = model.addBody("on " + joint.name, static_cast<int>(model.bodies.size()) - 1, joint, ball);
    model.bodies[static_cast<std::size_t>(i)].joint.placement = random.pose();
  }
  model.bodies[8].joint.coupling = {"mimic", "thumb", {{"coefficients", std::vector<double>{0.1, 0.5, -0.3}}}};
  auto& parts = std::get<std::vector<JointDescription>>(model.bodies[9].joint.parameters.at("parts"));
  for (JointDescription& part : parts) part.placement = random.pose();
  const std::vector<double> r{0.5, -0.5, 0.1, 0.7}, turned{0.1, 0.2, 0.3, 0.5, -0.5, 0.1, 0.7}, six{1, 2, 3, 4, 5, 6};
  model.configurations = {{.name = "home",
                           .joints = {{"free", turned, six},
                                      {"wheel", {0.6, -0.8}, {2}},
                                      {"plane", {0.3, 0.4, 0.6, 0.8}, {1, 2, 3}},
                                      {"screw", {0.7}, {1.5}},
                                      {"socket", r, {1, 2, 3}},
                                      {"loose", turned, six},
                                      {"thumb", {0.9}, {1.1}},
                                      {"series", {0.2, 0.5, -0.5, 0.1, 0.7, 0.4}, {1, 2, 3, 4, 5}}}},
                          {.name = "zero"}};
  const std::string lost = lostBy(model);
  const Model read = again(model);
  checkSameState(model, read, "zero");
  // Named states know nothing of velocities of dependent joints.
  for (ConfigurationDescription& state : model.configurations)
    if (state.name == "home") state.joints.push_back({"finger", {0.1 + 0.5 * 0.9 - 0.3 * 0.81}, {(0.5 - 0.6 * 0.9) * 1.1}});
  model.bodies[8].joint.coupling = {};
  checkSameState(model, read, "home");
  for (const char* what :
       {"places of free joints", "cos and sin of continuous joints", "'planar', which become two slides and a hinge",
        "'helical', which become a hinge and a slide, tied by an equality", "'free_flyer', which become three slides and a ball",
        "dependent joints, which become joints of their own, tied by an equality of 'finger'", "joints that no body of MuJoCo has together"})
    CHECK_THAT(lost, containing(what));
  REQUIRE(read.constraints.size() == 2);
  const auto& gear = std::get<JointCoupling>(read.constraints[1].relation);
  CHECK(gear.joint == "finger");
  CHECK(gear.coupling.master == "thumb");
  CHECK(std::get<std::vector<double>>(gear.coupling.parameters.at("coefficients")) == std::vector<double>{0.1, 0.5, -0.3});
}

TEST_CASE("bodies, volumes, limits, losses, constraints and pairs come back from MJCF", "[mjcf]") {
  Model model;
  model.name = "all";
  model.gravity = {1, 2, 3};
  model.addBody("base", 0, jointOf("base_fixed", "fixed"), ball);
  JointDescription j = hinge("a_joint");
  j.limits = {.lower = {-1}, .upper = {2}, .effort = {3}};
  j.armature = {0.1};
  j.damping = {0.2};
  j.friction = {0.3};
  j.placement = {exp3(Vec3<double>{0.3, -1.2, 2.5}), {1, 2, 3}};
  model.addBody("a", 1, j, ball);
  JointDescription socket = jointOf("b_joint", "spherical");
  socket.armature = {0.4, 0.4, 0.4};
  socket.damping = {0.5, 0.5, 0.5};
  model.addBody("b", 2, socket, ball);
  model.addBody("c", 2, jointOf("c_joint", "prismatic", {{"axis", std::vector<double>{0, 0, 1}}}), ball);
  model.addFrame("one", 3, {exp3(Vec3<double>{1, 2, 3}), {0.1, 0.2, 0.3}});
  model.addFrame("other", 4, {});
  model.constraints = {closeLoop("point", "one", "other", {false, false, false, true, true, true}), closeLoop("glue", "one", "other"),
                       coupleJoint("c_joint", {"mimic", "a_joint", {{"coefficients", std::vector<double>{0.1, 2}}}}), lockJoint("a_joint", {0.7})};
  for (ConstraintDescription& c : model.constraints) c.baumgarte = {100, 20};
  model.disabled_collisions = {{"a", "c", "exclude"}};
  model.configurations = {{.name = "home", .joints = {{"a_joint", {0.5}, {}}, {"b_joint", {0, 0.6, 0, 0.8}, {}}, {"c_joint", {1.5}, {}}}}};
  using namespace geometry;
  const SE3<double> X{exp3(Vec3<double>{0.1, 0.2, 0.3}), {1, 2, 3}};
  const std::vector<Vec3<double>> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const GeometryShape& shape :
       {GeometryShape(Sphere{0.1}), GeometryShape(Box{{1, 2, 3}}), GeometryShape(Capsule{1, 2}), GeometryShape(Cylinder{1, 2}),
        GeometryShape(ConvexHull{corners}), GeometryShape(MeshFile{"b.stl", {1, 2, 3}, true}), GeometryShape(MeshFile{"b.stl", {1, 2, 4}, true})})
    model.addGeometry("shape_" + std::to_string(model.geometries.size()), 2, X, shape);
  model.geometries.push_back(
      {"seen", 3, X, TriangleMesh{corners, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}}, GeometryDescription::Role::visual, {}});
  model.addGeometry("ground", 0, X, HalfSpace{});
  CHECK_THAT(lostBy(model), Catch::Matchers::Equals(""));
  const Model read = again(model);
  CHECK_THAT(textOf(differences(model, read, 1e-14)), Catch::Matchers::Equals(""));
  CHECK(checkSameMotion(model, read).empty());
}

TEST_CASE("pairs of volumes become bits of contype and conaffinity, as many as there are", "[mjcf]") {
  const auto apart = [](int pairs) {
    Model model;
    for (int k = 0; k < 2 * pairs; ++k) {
      const std::string name = std::to_string(k);
      model.addBody("b" + name, 0, hinge("j" + name), ball);
      model.addGeometry("g" + name, k + 1, {}, geometry::Sphere{1});
      if (k % 2) model.disabled_collisions.push_back({"g" + std::to_string(k - 1), "g" + name, "contype and conaffinity"});
    }
    return model;
  };
  for (const int pairs : {0, 1, 30}) {
    INFO(pairs);
    const Model model = apart(pairs);
    CHECK(lostBy(model) == "");
    CHECK(textOf(differences(model, again(model), 1e-14)) == "");
  }
  CHECK_THAT(lostBy(apart(31)), containing("pairs of volumes without collision checks, for which contype has too few bits, 31 times, first of 'g0'"));
  // The name of a body means all of its volumes.
  Model model = apart(1);
  model.addGeometry("more", 1, {}, geometry::Sphere{1});
  model.disabled_collisions = {{"b0", "g1", ""}};
  CHECK(lostBy(model) == "");
  CHECK(again(model).disabled_collisions.size() == 2);
}

TEST_CASE("a loop that turns about one axis becomes two connected points", "[mjcf]") {
  Model model = load(DYN_SOURCE_DIR "/models/four_bar.urdf", {.continuous = Continuous::angle});
  const Model read = again(model);
  REQUIRE(read.constraints.size() == 2);
  const CompactModel first = compile(model, registry()), second = compile(read, registry());
  const ConstraintSet loop(first), points(second);
  Data d1(first, Need::mass_matrix), d2(second, Need::mass_matrix);
  ConstraintData c1(loop), c2(points);
  Eigen::VectorXd q(3), v(3);
  q << 0.4, 0.5, 0.2;
  v << 2, 0, 0;
  const Assembly one = projectConfiguration(first, d1, q, c1), other = projectConfiguration(second, d2, q, c2);
  REQUIRE(one.closed);
  REQUIRE(other.closed);
  CHECK((one.q - other.q).norm() < 1e-9);
  const Eigen::VectorXd w = projectVelocity(first, d1, one.q, v, c1), zero = Eigen::VectorXd::Zero(3);
  CHECK((constraintDynamics(first, d1, one.q, w, zero, c1).ddq - constraintDynamics(second, d2, one.q, w, zero, c2).ddq).norm() < 1e-9);
}

TEST_CASE("bodies without mass between joints become several joints of one body", "[mjcf]") {
  Model model;
  model.addBody("gimbal", 0, hinge("first"));
  model.addBody("fork", 1, hinge("second", {1, 0, 0}));
  model.bodies[2].joint.placement = {exp3(Vec3<double>{0.3, -1.2, 2.5}), {0.1, 0.2, 0.3}};
  model.addBody("camera", 2, jointOf("third", "spherical"), ball);
  model.bodies[3].joint.placement = {exp3(Vec3<double>{-1, 0.5, 0.5}), {0.3, 0, 0.3}};
  const Written written = mjcf::write(model);
  CHECK_THAT(joined(written.lost), containing("bodies without mass and volumes, which become joints of the next body, 2 times, first of 'gimbal'"));
  CHECK(written.text.find("gimbal") == std::string::npos);
  CHECK(checkSameMotion(model, again(model)) == std::vector<std::string>{"gimbal", "fork"});
  // A frame of it needs the body.
  model.addFrame("mark", 1, {});
  CHECK_THAT(lostBy(model), containing("bodies that move without mass or without inertia, which MuJoCo refuses of 'gimbal'"));
  CHECK(checkSameMotion(model, again(model)) == std::vector<std::string>{"fork"});
}

TEST_CASE("devices of joints and of fixed tendons come back from MJCF; others are reported", "[mjcf]") {
  const std::string file =
      "<mujoco><worldbody><body><joint name=\"i\"/><geom size=\"1\"/><body><joint name=\"j\"/><joint name=\"b\" type=\"ball\"/><geom size=\"1\"/>"
      "<site name=\"s\"/></body></body></worldbody><default><motor gear=\"3\"/></default><actuator><motor name=\"m\" joint=\"i\"/>"
      "<motor name=\"pull\" tendon=\"t\"/><motor name=\"at\" site=\"s\"/><motor name=\"turn\" joint=\"b\"/></actuator>"
      "<sensor><jointpos joint=\"j\"/></sensor><tendon><fixed name=\"t\"><joint joint=\"i\" coef=\"2\"/><joint joint=\"j\" coef=\"-1\"/></fixed>"
      "<spatial name=\"rope\"><site site=\"s\"/><site site=\"s\"/></spatial></tendon></mujoco>";
  const Model model = mjcf::parse(file, "robot.xml", {});
  REQUIRE(model.devices.size() == 7);
  const Model back = again(model);
  std::vector<std::string> texts;
  for (const DeviceDescription& device : back.devices) texts.push_back(device.text);
  CHECK(texts == std::vector<std::string>{model.devices[0].text, model.devices[1].text, model.devices[4].text, model.devices[6].text});
  CHECK(texts[0] == R"(<motor name="m" joint="i" gear="3"/>)");
  CHECK_THAT(lostBy(model), containing("actuators, tendons and sensors, 3 times, first of 'rope'"));
}

TEST_CASE("what MJCF cannot say is reported once each, with its first owner", "[mjcf]") {
  Model model;
  JointDescription odd = hinge("odd");
  odd.limits = {.lower = {-1}, .upper = {infinity}, .velocity = {1}, .effort = {0}};
  model.addBody("world", 0, jointOf("own name", "fixed"), {1, {}, {1, 0, 0, 1, 0, 5}});
  model.addBody("b", 1, odd, ball);
  JointDescription socket = jointOf("socket", "spherical");
  socket.damping = {1, 2, 3};
  model.addBody("c", 2, socket, ball);
  JointDescription stiff = hinge("stiff");
  stiff.limits = {.lower = {1}, .upper = {1}};
  stiff.coupling = {"mimic", "odd", {{"coefficients", std::vector<double>(6, 1)}}};
  model.addBody("d", 3, stiff);
  model.addFrame("tip", 2, {});
  using namespace geometry;
  for (const GeometryShape& shape : {GeometryShape(Cone{1, 2}), GeometryShape(Voxels{}), GeometryShape(OctreeFile{"c.bt"}), GeometryShape(Sphere{}),
                                     GeometryShape(HalfSpace{}), GeometryShape(MeshFile{"package://a/b.stl"}), GeometryShape(MeshFile{"/b.dae"}),
                                     GeometryShape(MeshFile{"b.stl"}), GeometryShape(ConvexHull{{{1, 2, 3}}})})
    model.addGeometry("shape_" + std::to_string(model.geometries.size()), 2, {}, shape);
  model.constraints = {pointContact("tip"), lockJoint("odd"), closeLoop("slot", "tip", "universe", {true, false, false, false, false, false})};
  model.disabled_collisions = {{"world", "b", "adjacent"}};
  model.groups = {{.name = "arm"}};
  model.configurations = {{.name = "home", .group = "arm"}, {.name = "home"}};
  const std::string lost = lostBy(model);
  for (const char* what : {"names of bodies that are called as MuJoCo's world is of 'world'",
                           "names of fixed joints of 'own name'",
                           "inertias that no body has, which MuJoCo refuses",
                           "infinite limits beside finite ones, which become the largest number of 'odd'",
                           "limits of velocity",
                           "limits of effort of zero of 'odd'",
                           "that differ between their axes of 'socket'",
                           "ranges of a single position of 'stiff'",
                           "couplings of joints that are no polynomial",
                           "bodies that move without mass or without inertia, which MuJoCo refuses of 'd'",
                           "volumes: cones",
                           "volumes: voxels",
                           "volumes: octrees",
                           "volumes: points",
                           "volumes: half-spaces on bodies that move",
                           "volumes: meshes that package://",
                           "volumes: meshes of files that are neither",
                           "whether a mesh is its surface or its convex hull",
                           "volumes: meshes of fewer than four points",
                           "contacts of frames",
                           "locks of joints",
                           "loops that slide",
                           "reasons of pairs without collision checks of 'adjacent'",
                           "groups (an SRDF has them)",
                           "groups of named states",
                           "names of states that several have"}) {
    INFO(what);
    CHECK_THAT(lost, containing(what));
  }
  model.bodies[4].joint.coupling = {};
  model.bodies[3].joint.damping.clear();
  CHECK(checkSameMotion(model, again(model)) == std::vector<std::string>{"world"});
}

TEST_CASE("models that MJCF cannot hold at all are refused", "[mjcf]") {
  Model model;
  model.addBody("a", 0, hinge("j"), {std::numeric_limits<double>::quiet_NaN(), {}, {}});
  CHECK_THROWS_WITH(mjcf::write(model), containing("is not finite"));
  model.bodies[1].inertia = {};
  model.bodies[1].joint = jointOf("j", "ellipsoid", {{"radii", std::vector<double>{1, 2, 3}}});
  CHECK_THROWS_WITH(mjcf::write(model), containing("its type 'ellipsoid' is not made of free, ball, hinge and slide"));
  model.bodies[1].joint = jointOf("j", "revolute");
  CHECK_THROWS_WITH(mjcf::write(model), containing("its parameter 'axis' must be three numbers"));
  model.bodies[1].joint = hinge("j");
  model.bodies[1].joint.coupling = {"mimic", "j", {{"coefficients", std::vector<double>{1, 2}}}};
  model.configurations = {{.name = "home"}};
  CHECK_THROWS_WITH(mjcf::write(model), containing("follow each other in a circle"));
  model.bodies[1].joint.coupling = {};
  model.configurations = {{.name = "home", .joints = {{"j", {1, 2}, {}}}}};
  CHECK_THROWS_WITH(mjcf::write(model), containing("has 2 coordinates of it, but it has 1"));
  model.configurations = {{.name = "home", .joints = {{"k", {1}, {}}}}};
  CHECK_THROWS_WITH(mjcf::write(model), containing("names joint 'k', which does not exist"));
  model.configurations.clear();
  model.bodies[1].parent = 7;
  CHECK_THROWS_WITH(mjcf::write(model), containing("body 7"));
  model.bodies.clear();
  CHECK_THROWS_AS(mjcf::write(model), Error);
}

TEST_CASE("bodies are nested as deep as readers of XML take", "[mjcf]") {
  Model model;
  for (int i = 0; i < 96; ++i) model.addBody("b" + std::to_string(i), i, hinge("j" + std::to_string(i)), ball);
  CHECK(again(model).bodies.size() == 97);
  model.addBody("last", 96, hinge("last"), ball);
  CHECK_THROWS_WITH(mjcf::write(model), containing("nested deeper than 96"));
}
