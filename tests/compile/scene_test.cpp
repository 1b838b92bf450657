// SPDX-License-Identifier: BSD-2-Clause
// The compiler leaves out bodies that a scene does not need. The other bodies move as before.
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

using Vector = Eigen::VectorXd;

/// Two random trees on one world. Names in the second tree have a prefix.
Model pair() {
  Model first = randomTree(registry(), 8, 11), second = randomTree(registry(), 9, 12);
  second.gravity = first.gravity;
  return append(first, second, "universe", {}, "other/");
}

/// The coordinates or velocities of the joints of `part`, picked from those of the whole.
Vector pick(const CompactModel& whole, const CompactModel& part, const Vector& x, bool configuration) {
  Vector out(configuration ? part.nq() : part.nv());
  for (const JointRecord& joint : part.joints()) {
    if (joint.nv == 0) continue;
    const JointRecord& same = whole.joints()[static_cast<std::size_t>(whole.findJoint(joint.name))];
    if (configuration) {
      out.segment(joint.idx_q, joint.nq) = x.segment(same.idx_q, same.nq);
    } else {
      out.segment(joint.idx_v, joint.nv) = x.segment(same.idx_v, same.nv);
    }
  }
  return out;
}

bool reports(const CompactModel& model, const std::string& text) {
  for (const std::string& line : model.report().passes)
    if (line.find(text) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("an island without outputs is left out, and the other one moves as it does in the whole", "[scene]") {
  const Model description = pair();
  CompileOptions options;
  options.scene.outputs = {"tool"};
  const CompactModel whole = compile(description, registry()), part = compile(description, registry(), options);
  CHECK(part.nv() < whole.nv());
  CHECK(part.findJoint("other/j0") < 0);
  CHECK(reports(part, "scene: 9 of 17 bodies left out, 1 of 2 frames"));
  CHECK_FALSE(reports(whole, "scene:"));
  Random random(5);
  const Vector q = integrate(whole, neutral(whole), random.vector(whole.nv(), 0.5)), v = random.vector(whole.nv(), 0.5);
  for (const Integrator integrator : {Integrator::rk4, Integrator::dormand_prince, Integrator::gauss6}) {
    const SimulatorOptions simulation{.integrator = integrator, .dt = 0x1p-9};
    Simulator all(whole, simulation), some(part, simulation);
    all.reset(q, v);
    some.reset(pick(whole, part, q, true), pick(whole, part, v, false));
    all.advance(0.05);
    some.advance(0.05);
    const Vector expected = pick(whole, part, all.q(), true);
    INFO(infoOf(integrator).name);
    // The adaptive method chooses its steps from all bodies, so the results agree only to its tolerance. With fixed steps only small differences
    // remain: bodies share lanes, and implicit methods solve for all bodies at once.
    CHECK(distance(part, some.q(), expected) < (integrator == Integrator::dormand_prince ? 1e-7 : 1e-12));
  }
}

TEST_CASE("what is tied to an output stays", "[scene]") {
  Model description = pair();
  const auto kept = [&](const Scene& scene) {
    CompileOptions options;
    options.scene = scene;
    return compile(description, registry(), options).findJoint("other/j0") >= 0;
  };
  CHECK_FALSE(kept({{"tool"}, {}, true}));
  CHECK(kept({{"other/tool"}, {}, true}));
  CHECK(kept({{"tool"}, {"b3", "other/b2"}, true}));
  CHECK_FALSE(kept({{"tool"}, {"b3", "b4"}, true}));
  CHECK(kept({{}, {}, true}));
  description.constraints.push_back(closeLoop("rope", "b2", "other/b4", {false, false, false, true, true, true}));
  CHECK(kept({{"tool"}, {}, true}));
}

TEST_CASE("without dynamics only what carries an output stays, and it stands where it stood", "[scene]") {
  const Model description = pair();
  CompileOptions options;
  options.scene = {{"b2"}, {}, false};
  const CompactModel whole = compile(description, registry()), part = compile(description, registry(), options);
  CHECK(part.njoints() <= 4);
  const Vector q = randomConfiguration(whole, 3);
  Data all(whole), some(part);
  forwardKinematics(whole, all, q);
  forwardKinematics(part, some, pick(whole, part, q, true));
  const SE3<double> a = framePlacement(whole, all, whole.findFrame("b2")), b = framePlacement(part, some, part.findFrame("b2"));
  for (int k = 0; k < 9; ++k) CHECK(std::abs(a.R.m[k] - b.R.m[k]) < 1e-14);
  for (int k = 0; k < 3; ++k) CHECK(std::abs(a.p[k] - b.p[k]) < 1e-13);
}

TEST_CASE("a link and a joint of one name are told apart", "[scene]") {
  // Joint "finger" carries link "tip". Joint "thumb", on another tree, depends on joint "finger". Link "finger" is on neither tree.
  const auto slider = [](const std::string& name) {
    JointDescription joint;
    joint.name = name;
    joint.type = "prismatic";
    joint.parameters["axis"] = std::vector<double>{1, 0, 0};
    return joint;
  };
  const Inertia<double> Y{1, {}, {1, 0, 0, 1, 0, 1}};
  Model model;
  model.addBody("finger", 0, slider("base"), Y);
  model.addBody("tip", 0, slider("finger"), Y);
  model.addBody("thumb", 0, slider("thumb"), Y);
  model.bodies[3].joint.coupling = {"mimic", "finger", {{"coefficients", std::vector<double>{0, 1}}}};
  CHECK(islandsOf(model) == std::vector<std::string>{"finger", "tip"});
  const auto joints = [&](const std::string& output, bool dynamics) {
    CompileOptions options;
    options.scene = {{output}, {}, dynamics};
    std::vector<std::string> names;
    const CompactModel part = compile(model, registry(), options);
    for (const JointRecord& joint : part.joints())
      if (joint.name != "universe") names.push_back(joint.name);
    return names;
  };
  for (const bool dynamics : {true, false}) {
    CHECK(joints("thumb", dynamics) == std::vector<std::string>{"finger", "thumb"});
    CHECK(joints("finger", dynamics) == std::vector<std::string>{"base"});
  }
  model.bodies[3].joint.coupling = {};
  model.constraints = {coupleJoint("thumb", {"mimic", "finger", {{"coefficients", std::vector<double>{0, 1}}}}), lockJoint("finger")};
  CHECK(joints("thumb", true) == std::vector<std::string>{"finger", "thumb"});
  CompileOptions options;
  options.scene.outputs = {"base"};
  CHECK(reports(compile(model, registry(), options), "2 of 2 constraints"));
}

TEST_CASE("a scene that speaks of what is not there is refused", "[scene]") {
  CompileOptions options;
  options.scene.outputs = {"elbow"};
  CHECK_THROWS_WITH(compile(pair(), registry(), options), containing("'elbow'"));
  const std::string name = pair().bodies.at(3).name;
  options.scene.outputs = {name + "_"};
  CHECK_THROWS_WITH(compile(pair(), registry(), options), containing("did you mean") && containing("'" + name + "'"));
}

TEST_CASE("what touches is tied together, whatever of it is fixed to the world", "[scene]") {
  Model model;
  for (const char* name : {"a", "b", "c"}) {
    JointDescription joint;
    joint.name = std::string("joint_") + name;
    joint.type = "free_flyer";
    model.addBody(name, 0, joint, {1, {}, {1, 0, 0, 1, 0, 1}});
  }
  model.addFrame("ground", 0, {});
  const std::vector<std::vector<std::string>> orders = {{"a", "ground", "b"}, {"a", "b", "ground"}, {"ground", "a", "universe", "b"}};
  for (const std::vector<std::string>& touching : orders) {
    CHECK(islandsOf(model, touching) == std::vector<std::string>{"a", "c"});
    CompileOptions options;
    options.scene.outputs = {"a"};
    options.scene.touching = touching;
    CHECK(compile(model, registry(), options).nv() == 12);
  }
}

TEST_CASE("what a part of a joint follows belongs to its island", "[scene]") {
  JointDescription leader, part, dependent;
  leader.name = "leader";
  leader.type = part.type = "revolute";
  leader.parameters["axis"] = part.parameters["axis"] = std::vector<double>{0, 0, 1};
  part.coupling = {"mimic", "leader", {{"coefficients", std::vector<double>{0, 1}}}};
  dependent.name = "follower";
  dependent.type = "composite";
  dependent.parameters["parts"] = std::vector<JointDescription>{part};
  Model model;
  model.addBody("a", 0, leader, {1, {}, {1, 0, 0, 1, 0, 1}});
  model.addBody("b", 0, dependent, {1, {}, {1, 0, 0, 1, 0, 1}});
  CHECK(islandsOf(model) == std::vector<std::string>{"a"});
  for (const bool dynamics : {true, false}) {
    CompileOptions options;
    options.scene.outputs = {"b"};
    options.scene.dynamics = dynamics;
    CHECK(compile(model, registry(), options).nv() == 1);
  }
  leader.coupling = {"mimic", "follower/0", part.coupling.parameters};
  std::get<std::vector<JointDescription>>(model.bodies[2].joint.parameters.at("parts"))[0].coupling = {};
  model.bodies[1].joint = leader;
  CHECK(islandsOf(model) == std::vector<std::string>{"a"});
}
