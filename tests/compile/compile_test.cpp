// SPDX-License-Identifier: BSD-2-Clause
// Guarantees of each pass of the compiler, tested through the public API.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/spatial/eigen.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

JointDescription revolute(const std::string& name, const Vec3<double>& axis = {0, 0, 1}, const SE3<double>& placement = {}) {
  JointDescription joint;
  joint.name = name;
  joint.type = "revolute";
  joint.parameters["axis"] = std::vector<double>{axis.x, axis.y, axis.z};
  joint.placement = placement;
  return joint;
}

JointDescription rigid(const std::string& name, const SE3<double>& placement = {}) {
  JointDescription joint;
  joint.name = name;
  joint.placement = placement;
  return joint;
}

const std::string* passOf(const CompactModel& model, const std::string& pass) {
  for (const std::string& line : model.report().passes)
    if (line.rfind(pass + ":", 0) == 0) return &line;
  return nullptr;
}

bool warns(const CompactModel& model, const std::string& text) {
  for (const std::string& line : model.report().warnings)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

double off(const SE3<double>& a, const SE3<double>& b) { return (toEigen(a) - toEigen(b)).cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("resolve: names are unique, parents come first, values are finite", "[compile]") {
  Model model;
  model.addBody("a", 0, revolute("j"), {1, {}, {1, 0, 0, 1, 0, 1}});
  model.addBody("b", 1, revolute("k"), {1, {}, {1, 0, 0, 1, 0, 1}});
  const auto refused = [&](const char* text) { CHECK_THROWS_WITH(compile(model, registry()), containing(text)); };
  SECTION("bodies") {
    model.bodies[2].name = "a";
    refused("'a'");
  }
  SECTION("joints") {
    model.bodies[2].joint.name = "j";
    refused("'j'");
  }
  SECTION("frames and bodies share their names") {
    model.addFrame("b", 1, {});
    refused("'b'");
  }
  SECTION("parents") {
    model.bodies[1].parent = 2;
    refused("parent");
  }
  SECTION("a frame on a body that does not exist") {
    model.addFrame("f", 1, {});
    model.frames[0].body = 9;
    refused("'f'");
  }
  SECTION("mass") {
    model.bodies[1].inertia.mass = -1;
    refused("negative");
  }
  SECTION("inertia") {
    model.bodies[1].inertia.rotational.xy = std::nan("");
    refused("not finite");
  }
  SECTION("types") {
    model.bodies[1].joint.type = "hinge";
    refused("'hinge'");
  }
  SECTION("sizes") {
    model.bodies[1].joint.damping = {1, 2};
    refused("damping has 2 entries");
  }
  SECTION("losses and armature") {
    JointDescription& joint = model.bodies[1].joint;
    for (const double x : {-1.0, std::numeric_limits<double>::infinity(), std::nan("")}) {
      joint.damping = {x};
      refused("damping has an entry that is negative or not finite");
      joint.damping.clear();
      joint.friction = {x};
      refused("friction has an entry that is negative or not finite");
      joint.friction.clear();
      joint.armature = {x};
      refused("armature has an entry that is negative or not finite");
      joint.armature.clear();
    }
  }
  SECTION("the world's name") {
    model.bodies[1].name = "universe";
    refused("the world's own name");
  }
  SECTION("limits the wrong way round") {
    model.bodies[1].joint.limits.lower = {2};
    model.bodies[1].joint.limits.upper = {1};
    refused("joint 'j': its lower limit is above its upper one");
  }
  SECTION("placements") {
    SE3<double>& X = model.bodies[1].joint.placement;
    SECTION("are finite") {
      X.p.y = std::nan("");
      refused("joint 'j': its placement has an entry that is not finite");
    }
    SECTION("turn") {
      const double no = GENERATE(std::nan(""), -1.0, 0.0, 0x1p-10, 1000.0);
      for (double& x : X.R.m) x *= no;
      refused("joint 'j': its placement has a matrix that is no rotation");
    }
    SECTION("may have been written with two digits") {
      X.R.m[0] = X.R.m[4] = X.R.m[3] = 0.71;
      X.R.m[1] = -0.71;
      CHECK_NOTHROW(compile(model, registry()));
    }
    SECTION("of frames, too") {
      model.addFrame("f", 1, {Mat3<double>{}, {}});
      refused("frame 'f': its placement has a matrix that is no rotation");
    }
  }
  SECTION("gravity") {
    model.gravity.x = std::nan("");
    refused("gravity");
  }
  SECTION("a rigid master") {
    model.bodies[1].joint = rigid("j");
    model.bodies[2].joint.coupling = {"mimic", "j", {{"coefficients", std::vector<double>{0, 1}}}};
    refused("rigid");
  }
}

TEST_CASE("resolve: a description without the universe is refused wherever it is given", "[compile]") {
  Model empty;
  empty.bodies.clear();
  const std::string says = "bodies[0] is the universe";
  CHECK_THROWS_WITH(compile(empty, registry()), containing(says));
  CHECK_THROWS_WITH(reduce(empty, registry(), {}), containing(says));
  CHECK_THROWS_WITH(append(Model(), empty, "universe"), containing(says));
  CHECK_THROWS_WITH(empty.addBody("a", 0, {}, {}), containing(says));
}

TEST_CASE("resolve: a rigid joint that follows another is rigid, with a warning", "[compile]") {
  Model model;
  model.addBody("a", 0, revolute("j"), {1, {}, {1, 0, 0, 1, 0, 1}});
  JointDescription dependent = rigid("k");
  dependent.coupling = {"mimic", "j", {{"coefficients", std::vector<double>{0, 1}}}};
  model.addBody("b", 1, dependent, {1, {}, {1, 0, 0, 1, 0, 1}});
  const CompactModel compact = compile(model, registry());
  CHECK(compact.nv() == 1);
  CHECK(warns(compact, "'k'"));
}

TEST_CASE("resolve: joints made of joints have no coupling, and what their parts say is checked", "[compile]") {
  Model model;
  const Inertia<double> Y{1, {}, {1, 0, 0, 1, 0, 1}};
  model.addBody("a", 0, revolute("ja"), Y);
  JointDescription joint;
  joint.name = "j";
  joint.type = "composite";
  std::vector<JointDescription> parts{revolute("first"), revolute("second")};
  SECTION("a coupling") {
    joint.coupling = {"mimic", "ja", {{"coefficients", std::vector<double>{0, 1}}}};
    joint.parameters["parts"] = parts;
    model.addBody("b", 1, joint, Y);
    CHECK_THROWS_WITH(compile(model, registry()), containing("'j'") && containing("couple one of its parts"));
  }
  SECTION("the coupling of a part") {
    parts[1].coupling = {"mimic", "ja", {{"coefficients", std::vector<double>{0, 1}}}};
    joint.parameters["parts"] = parts;
    model.addBody("b", 1, joint, Y);
    CHECK(compile(model, registry()).nv() == 2);
  }
  SECTION("limits and losses, of parts of parts as well") {
    const auto refused = [&](const char* text) {
      JointDescription inner;
      inner.name = "inner";
      inner.type = "composite";
      inner.parameters["parts"] = parts;
      joint.parameters["parts"] = std::vector<JointDescription>{revolute("before"), inner};
      model.addBody("b", 1, joint, Y);
      CHECK_THROWS_WITH(compile(model, registry()), containing("'j/inner") && containing(text));
    };
    SECTION("of wrong size") {
      parts[1].damping = {1, 2, 3};
      refused("damping has 3 entries, the joint wants 1");
    }
    SECTION("the wrong way round") {
      parts[0].limits.lower = {2};
      parts[0].limits.upper = {1};
      refused("lower limit is above");
    }
  }
  SECTION("what a part says holds unless the joint says otherwise") {
    parts[0].damping = {3};
    parts[1].limits.upper = {0.5};
    JointDescription inner;
    inner.type = "composite";
    inner.limits.lower = {-1, -2};
    inner.parameters["parts"] = parts;
    joint.parameters["parts"] = std::vector<JointDescription>{inner};
    model.addBody("b", 1, joint, Y);
    const CompactModel compact = compile(model, registry());
    CHECK(compact.limits().lower == std::vector<double>{-HUGE_VAL, -1, -2});
    CHECK(compact.limits().upper == std::vector<double>{HUGE_VAL, HUGE_VAL, 0.5});
    Data data(compact);
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3), v = Eigen::Vector3d(0, 1, 0);
    CHECK(rnea(compact, data, zero, v, zero)[1] == 3);
  }
}

TEST_CASE("order: depth first, children as described, frames behind the bodies", "[compile]") {
  Model model;
  const Inertia<double> Y{1, {}, {1, 0, 0, 1, 0, 1}};
  const int a = model.addBody("a", 0, revolute("ja"), Y), b = model.addBody("b", 0, revolute("jb"), Y);
  model.addBody("b1", b, revolute("jb1"), Y);
  model.addBody("a1", a, revolute("ja1"), Y);
  model.addBody("a2", a, revolute("ja2"), Y);
  model.addFrame("tool", b, {});
  const CompactModel compact = compile(model, registry());
  std::vector<std::string> joints, frames;
  for (const JointRecord& r : compact.joints()) joints.push_back(r.name);
  for (const FrameRecord& f : compact.frames()) frames.push_back(f.name);
  CHECK(joints == std::vector<std::string>{"universe", "ja", "ja1", "ja2", "jb", "jb1"});
  CHECK(frames == std::vector<std::string>{"universe", "a", "a1", "a2", "b", "b1", "tool"});
  CHECK(compact.joints()[5].parent == 4);
  CHECK(compact.joints()[3].parent == 1);
  CHECK(compact.joints()[4].parent == 0);
}

TEST_CASE("weld: bodies on rigid joints are summed into their carriers, and keep their frames", "[compile]") {
  Random random(4);
  Model model;
  const Inertia<double> ground = random.inertia(), arm = random.inertia(), motor = random.inertia(), hand = random.inertia();
  const SE3<double> G = random.pose(), M = random.pose(), H = random.pose();
  model.addBody("ground", 0, rigid("g", G), ground);
  model.addBody("arm", 1, revolute("j", random.vector(), random.pose()), arm);
  model.addBody("motor", 2, rigid("m", M), motor);
  model.addBody("hand", 3, rigid("h", H), hand);
  model.addFrame("tip", 4, M);
  const CompactModel welded = compile(model, registry());
  Model summed;
  summed.addBody("arm", 0, model.bodies[2].joint, arm + (motor + hand.transformed(H)).transformed(M));
  summed.bodies[1].joint.placement = G * summed.bodies[1].joint.placement;
  const CompactModel one = compile(summed, registry());
  CHECK(welded.njoints() == 2);
  CHECK(*passOf(welded, "weld") == "weld: 3 bodies welded to others, 1 move");
  // Bodies that are fixed to the world do not count in the mass.
  CHECK(welded.mass() == approx(arm.mass + motor.mass + hand.mass).epsilon(1e-15));
  Data data(welded), other(one);
  const Eigen::VectorXd q = random.vector(1, 2), v = random.vector(1, 2), a = random.vector(1, 2);
  CHECK(rnea(welded, data, q, v, a)[0] == approx(rnea(one, other, q, v, a)[0]).epsilon(1e-13));
  forwardKinematics(welded, data, q);
  const SE3<double> armPose = framePlacement(welded, data, welded.frameId("arm"));
  CHECK(off(framePlacement(welded, data, welded.frameId("motor")), armPose * M) < 1e-15);
  CHECK(off(framePlacement(welded, data, welded.frameId("hand")), armPose * M * H) < 2e-15);
  CHECK(off(framePlacement(welded, data, welded.frameId("tip")), armPose * M * H * M) < 2e-15);
  CHECK(off(framePlacement(welded, data, welded.frameId("ground")), G) == 0);
  CHECK(welded.frames()[static_cast<std::size_t>(welded.frameId("tip"))].joint == 1);
}

TEST_CASE("canonicalise: axes of every direction share a batch, and nothing of it shows", "[compile]") {
  Random random(5);
  Model model;
  model.addBody("b0", 0, revolute("j0", {1, 0, 0}, random.pose()), random.inertia());
  model.addBody("b1", 1, revolute("j1", {0, 1, 0}, random.pose()), random.inertia());
  model.addBody("b2", 2, revolute("j2", {0, 0, 1}, random.pose()), random.inertia());
  model.addBody("b3", 3, revolute("j3", {0.3, -2, 0.5}, random.pose()), random.inertia());
  const CompactModel compact = compile(model, registry());
  CHECK(*passOf(compact, "canonicalise") == "canonicalise: 3 joint axes turned onto z, 0 along axes of their parents, 0 origins where they cross");
  CHECK(passOf(compact, "pack")->find("1 type batches, 1 runs") != std::string::npos);
  Data data(compact);
  const Eigen::VectorXd q = random.vector(4, 2);
  forwardKinematics(compact, data, q);
  SE3<double> pose;
  for (int i = 0; i < 4; ++i) {
    const JointDescription& joint = model.bodies[static_cast<std::size_t>(i + 1)].joint;
    const auto& n = std::get<std::vector<double>>(joint.parameters.at("axis"));
    const Eigen::Vector3d axis = Eigen::Vector3d(n[0], n[1], n[2]).normalized() * q[i];
    pose = pose * joint.placement * SE3<double>{exp3(fromEigen3(axis)), {}};
    CHECK(off(jointPlacement(compact, data, i + 1), pose) < 4e-15);
    CHECK(off(framePlacement(compact, data, i + 1), pose) < 4e-15);
  }
}

TEST_CASE("canonicalise: origins are where axes cross, towards the mass that joints carry, and nothing of it shows", "[compile]") {
  // The axes of the shoulder's first two joints cross beyond the origin of the first. The wrist's axes cross beyond the forearm's origin, where the
  // hand's mass is. The upper arm's axis crosses the shoulder's axis behind it, where the compiler does not put origins.
  const struct {
    Vec3<double> axis, p;
  } joints[] = {{{0, 0, 1}, {0, 0, 0.1}},  {{0, 1, 0}, {0, 0, 0.21}}, {{0, 0, 1}, {0, 0, 0.2}}, {{0, -1, 0}, {0.05, 0, 0.2}},
                {{0, 0, 1}, {0, 0, 0.19}}, {{0, 1, 0}, {0, 0, 0.21}}, {{1, 0, 0}, {0.07, 0, 0}}};
  Random random(6);
  Model model;
  for (int i = 0; i < 7; ++i) {
    Inertia<double> inertia = random.inertia();
    inertia.com = i == 6 ? Vec3<double>{-0.1, 0, 0} : Vec3<double>{0, 0, 0.1};
    model.addBody("b" + std::to_string(i), i, revolute("j" + std::to_string(i), joints[i].axis, {Mat3<double>::identity(), joints[i].p}), inertia);
  }
  const CompactModel compact = compile(model, registry());
  CHECK(passOf(compact, "canonicalise")->find(" 3 origins where they cross") != std::string::npos);
  Data data(compact);
  const Eigen::VectorXd q = random.vector(7, 2), v = random.vector(7, 1), a = random.vector(7, 1);
  forwardKinematics(compact, data, q);
  SE3<double> pose;
  for (int i = 0; i < 7; ++i) {
    pose = pose * SE3<double>{exp3(q[i] * joints[i].axis), joints[i].p};
    CHECK(off(jointPlacement(compact, data, i + 1), pose) < 2e-15);
  }
  // The same robot with rotated link frames. After rounding no axes cross exactly.
  Model turned;
  SE3<double> before;
  for (int i = 0; i < 7; ++i) {
    const SE3<double> turn{exp3(random.vector(0.5)), {}}, back = turn.inverse(), step{Mat3<double>::identity(), joints[i].p};
    turned.addBody("b" + std::to_string(i), i, revolute("j" + std::to_string(i), back.R * joints[i].axis, before.inverse() * step * turn),
                   model.bodies[static_cast<std::size_t>(i + 1)].inertia.transformed(back));
    before = turn;
  }
  const CompactModel other = compile(turned, registry());
  Data expected(other);
  const Eigen::VectorXd tau = rnea(other, expected, q, v, a);
  CHECK((rnea(compact, data, q, v, a) - tau).cwiseAbs().maxCoeff() < 4e-15 * tau.cwiseAbs().maxCoeff());
}

TEST_CASE("canonicalise: axes that are next to parallel are not followed to where they cross", "[compile]") {
  Model model;
  const Inertia<double> inertia{1, {0.1, 0, 0.1}, {1, 0, 0, 1, 0, 1}};
  model.addBody("a", 0, revolute("j", {0, 0, 1}), inertia);
  model.addBody("b", 1, revolute("k", {0, 0, 1}, {exp3(Vec3<double>{1e-9, 0, 0}), {0, 0.3, 0}}), inertia);
  CHECK(passOf(compile(model, registry()), "canonicalise")->find(" 0 origins") != std::string::npos);
  // Joints with the same axis share their origin.
  model.bodies.back().joint.placement.p = {0, 0, 0.3};
  CHECK(passOf(compile(model, registry()), "canonicalise")->find(" 1 origins") != std::string::npos);
}

TEST_CASE("canonicalise: bodies whose axes are tilted from their parents' are where they are described", "[compile]") {
  // Rotations by pi/2 or pi, rounded as URDFs round them, rounded to doubles, a little off and far off, about one axis of the parent or about two.
  const double quarter = 1.5707963267948966;
  const Vec3<double> turns[] = {{1.57079632679, 0, 0}, {0, -quarter, 0}, {1.5708, 0, 0},     {0, 1.5708, 0},       {0, 0, 1.2},
                                {-0.9, 0, 0},          {0, 2.4, 0},      {-3.1416, 1e-9, 0}, {0.3, quarter, 1e-7}, {0.3, -0.4, 1.2}};
  for (const Vec3<double>& axis : {Vec3<double>{0, 0, 1}, Vec3<double>{-1, 0, 0}, Vec3<double>{0.6, 0, 0.8}}) {
    Model model;
    SE3<double> pose;
    int i = 0;
    for (const Vec3<double>& turn : turns) {
      const SE3<double> placement{exp3(turn), {0.1, -0.2, 0.3}};
      model.addBody("b" + std::to_string(i), i, revolute("j" + std::to_string(i), axis, placement), {1, {0.1, 0.2, 0.3}, {1, 0, 0, 2, 0, 3}});
      ++i;
    }
    const CompactModel compact = compile(model, registry());
    Data data(compact);
    forwardKinematics(compact, data, Eigen::VectorXd::Constant(i, 0.5));
    for (int j = 0; j < i; ++j) {
      pose = pose * SE3<double>{exp3(turns[j]), {0.1, -0.2, 0.3}} * SE3<double>{exp3(0.5 * axis), {}};
      CHECK(off(jointPlacement(compact, data, j + 1), pose) < 3e-15);
    }
  }
}

TEST_CASE("canonicalise: quarter turns that doubles round are quarter turns, all along a chain", "[compile]") {
  Model model;
  for (int i = 0; i < 7; ++i) {
    const SE3<double> placement{exp3(Vec3<double>{i % 2 == 0 ? 1.5707963267948966 : -1.5707963267948966, 0, 0}), {0, 0, 0.3}};
    model.addBody("b" + std::to_string(i), i, revolute("j" + std::to_string(i), {0, 0, 1}, placement), {1, {0.1, 0, 0.1}, {1, 0, 0, 1, 0, 1}});
  }
  CHECK(passOf(compile(model, registry()), "canonicalise")->find(" 7 along axes") != std::string::npos);
}

TEST_CASE("canonicalise: a placement written with two digits stays what it is", "[compile]") {
  Model model;
  const SE3<double> placement{{0.71, -0.71, 0, 0.71, 0.71, 0, 0, 0, 1}, {}};
  model.addBody("b", 0, revolute("j", {0, 0, 1}, placement), {1, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}});
  const CompactModel compact = compile(model, registry());
  Data data(compact);
  forwardKinematics(compact, data, Eigen::VectorXd::Constant(1, 0.5));
  CHECK(off(jointPlacement(compact, data, 1), placement * SE3<double>{exp3(Vec3<double>{0, 0, 0.5}), {}}) < 1e-15);
}

TEST_CASE("inspect: what moves no mass is reported, never divided by", "[compile]") {
  Model model;
  model.addBody("a", 0, revolute("j"), {1, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}});
  model.addBody("b", 1, revolute("k"));
  model.addBody("c", 2, revolute("l"));
  const CompactModel compact = compile(model, registry());
  CHECK(warns(compact, "'k'"));
  CHECK(warns(compact, "'l'"));
  CHECK(!warns(compact, "'j'"));
  Data data(compact);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  CHECK(rnea(compact, data, zero, zero, zero).allFinite());
  CHECK_THROWS_WITH(aba(compact, data, zero, zero, zero), containing("singular"));
  // With armature the mass matrix is not singular.
  for (BodyDescription& b : model.bodies) b.joint.armature = {0.1};
  model.bodies[0].joint.armature.clear();
  const CompactModel geared = compile(model, registry());
  CHECK(geared.report().warnings.empty());
  Data geared_data(geared);
  CHECK(aba(geared, geared_data, zero, zero, Eigen::VectorXd::Ones(3)).allFinite());
}

TEST_CASE("options: losses and rotors act unless they are turned off", "[compile]") {
  Model model;
  JointDescription joint = revolute("j");
  joint.damping = {0.5};
  joint.friction = {0.25};
  joint.armature = {2};
  model.addBody("a", 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  const auto torque = [&](const CompileOptions& options, double v, double a) {
    const CompactModel m = compile(model, registry(), options);
    Data data(m);
    return rnea(m, data, Eigen::VectorXd::Zero(1), Eigen::VectorXd::Constant(1, v), Eigen::VectorXd::Constant(1, a))[0];
  };
  CHECK(torque({}, 2, 1) == 1 + 0.25 + 1 + 2);
  CHECK(torque({}, -2, 0) == -1 - 0.25);
  CHECK(torque({}, 0, 0) == 0);
  CompileOptions bare;
  bare.dissipation = bare.armature = false;
  CHECK(torque(bare, 2, 1) == 1);
}

TEST_CASE("the same model with the same options gives the same results, bit for bit", "[compile]") {
  const Model model = randomTree(registry(), 20, 6, true);
  const CompactModel a = compile(model, registry()), b = compile(model, registry());
  CHECK(a.report().passes == b.report().passes);
  Data da(a, Need::mass_matrix), db(b, Need::mass_matrix);
  const Eigen::VectorXd q = randomConfiguration(a, 1), v = Eigen::VectorXd::Ones(a.nv());
  CHECK(rnea(a, da, q, v, v) == rnea(b, db, q, v, v));
  CHECK(crba(a, da, q) == crba(b, db, q));
}

TEST_CASE("a chain of couplings described last to first compiles in one pass", "[compile]") {
  // With quadratic work this test would take far too long.
  constexpr int n = 30000;
  Model model;
  for (int i = 0; i < n; ++i) {
    JointDescription joint = revolute("j" + std::to_string(i));
    if (i < n - 1) joint.coupling = {"mimic", "j" + std::to_string(i + 1), {{"coefficients", std::vector<double>{0, 1}}}};
    model.addBody("b" + std::to_string(i), 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  }
  const CompactModel compact = compile(model, registry());
  CHECK(compact.nv() == 1);
  Data data(compact);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(1);
  CHECK(rnea(compact, data, one, one, one)[0] == n);
  model.bodies.back().joint.coupling = {"mimic", "j0", {{"coefficients", std::vector<double>{0, 1}}}};
  CHECK_THROWS_WITH(compile(model, registry()), containing("circle"));
}

namespace {

/// Two independent joints on the world, one dependent joint for each, and a joint that depends on the first dependent joint.
Model dependents(const std::string& type = "revolute") {
  Model m;
  const auto joint = [&](const char* name, JointLimits limits, Coupling coupling = {}) {
    JointDescription j;
    j.name = name;
    j.type = type;
    j.parameters["axis"] = std::vector<double>{0, 0, 1};
    j.limits = std::move(limits);
    j.coupling = std::move(coupling);
    return j;
  };
  const auto follow = [](const char* master, std::vector<double> coefficients) {
    return Coupling{"mimic", master, {{"coefficients", std::move(coefficients)}}};
  };
  const Inertia<double> Y{1, {}, {1, 0, 0, 1, 0, 1}};
  m.addBody("a", 0, joint("lead", {{-2}, {2}, {3}, {}}), Y);
  m.addBody("b", 1, joint("follow", {{-1.5}, {0.5}, {4}, {}}, follow("lead", {0.1, -2})), Y);
  m.addBody("c", 1, joint("last", {{-0.2}, {}, {}, {}}, follow("follow", {0, 0.5})), Y);
  m.addBody("d", 0, joint("other", {}), Y);
  m.addBody("e", 4, joint("curved", {{}, {0.25}, {}, {}}, follow("other", {0, 0, 1})), Y);
  return m;
}

}  // namespace

TEST_CASE("limits of joints that follow others are limits of those that lead", "[compile]") {
  const CompactModel model = compile(dependents(), registry());
  const ModelLimits& limits = model.limits();
  REQUIRE(model.nq() == 2);
  // follow = 0.1 - 2 lead lies within [-0.4, 0.5], as last = follow / 2 may not be below -0.2.
  CHECK(limits.lower[0] == approx(-0.2).epsilon(1e-15));
  CHECK(limits.upper[0] == approx(0.25).epsilon(1e-15));
  CHECK(limits.velocity[0] == approx(2.0).epsilon(1e-15));
  // curved = other^2 <= 1/4.
  CHECK(limits.lower[1] == approx(-0.5).epsilon(1e-14));
  CHECK(limits.upper[1] == approx(0.5).epsilon(1e-14));
  CHECK(model.report().warnings.empty());
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const Eigen::VectorXd q = randomConfiguration(model, seed);
    CHECK(std::abs(q[1]) <= 0.5);
    CHECK(0.1 - 2 * q[0] <= 0.5 + 1e-15);
    CHECK(0.05 - q[0] >= -0.2 - 1e-15);
  }
}

TEST_CASE("limits of followers that cannot act are said", "[compile]") {
  Model apart = dependents();
  apart.bodies[2].joint.limits = {{5}, {6}, {}, {}};
  const CompactModel model = compile(apart, registry());
  REQUIRE(model.report().warnings.size() == 1);
  CHECK_THAT(model.report().warnings[0], containing("'follow', which follows 'lead', exclude"));
  CHECK(model.limits().lower[0] == -2);
  // A continuous joint has no position that could be limited.
  Model turning = dependents();
  turning.bodies[4].joint.type = "continuous";
  const CompactModel second = compile(turning, registry());
  REQUIRE(second.report().warnings.size() == 1);
  CHECK_THAT(second.report().warnings[0], containing("load it as an angle"));
}
