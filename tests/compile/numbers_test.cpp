// SPDX-License-Identifier: BSD-2-Clause
// withNumbers() makes the model that compile() would make of the changed description, to the last bit.
#include "compile/compact_impl.hpp"
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/parsers/load.hpp>
#include <dyn/spatial/eigen.hpp>

#include <cstring>
#include <limits>

using namespace dyn;
using namespace dyn::test;

namespace {

/// The description with these numbers.
Model changed(Model model, const ModelNumbers& numbers) {
  if (numbers.gravity) model.gravity = *numbers.gravity;
  const auto joint = [&](const std::string& name) -> JointDescription& {
    return model.bodies[static_cast<std::size_t>(model.findJoint(name))].joint;
  };
  for (const BodyInertia& x : numbers.inertias) model.bodies[static_cast<std::size_t>(model.findBody(x.body))].inertia = x.inertia;
  for (const JointPlacement& x : numbers.placements) joint(x.joint).placement = x.placement;
  for (const JointNumbers& x : numbers.damping) joint(x.joint).damping = x.values;
  for (const JointNumbers& x : numbers.friction) joint(x.joint).friction = x.values;
  for (const JointNumbers& x : numbers.armature) joint(x.joint).armature = x.values;
  return model;
}

template <class Value>
bool equal(const Value& a, const Value& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

void checkSameModel(const CompactModel& a, const CompactModel& b) {
  CHECK(a.report().passes == b.report().passes);
  CHECK(a.report().warnings == b.report().warnings);
  CHECK(a.report().held == b.report().held);
  CHECK(equal(a.mass(), b.mass()));
  CHECK(equal(a.gravity(), b.gravity()));
  CHECK(a.limits().lower == b.limits().lower);
  CHECK(dynamicParameters(a) == dynamicParameters(b));
  REQUIRE(a.frames().size() == b.frames().size());
  for (std::size_t i = 0; i < a.frames().size(); ++i) {
    CHECK(a.frames()[i].name == b.frames()[i].name);
    CHECK(equal(a.frames()[i].placement, b.frames()[i].placement));
  }
}

/// Equal, or both not numbers.
template <class A, class B>
bool same(const A& a, const B& b) {
  return ((a.array() == b.array()) || (a.array() != a.array() && b.array() != b.array())).all();
}

/// Runs everything that reads numbers of the model: single states with and without lane groups, batches, floats, constraints.
void checkSameResults(const CompactModel& a, const CompactModel& b, std::uint64_t seed) {
  const Eigen::VectorXd q = randomConfiguration(a, seed);
  Random random(seed);
  const Eigen::VectorXd v = random.vector(a.nv(), 1), x = random.vector(a.nv(), 10);
  const Need all = Need::derivatives | Need::jacobians | Need::kinematics;
  const auto evaluate = [&](const CompactModel& model) {
    Data data(model, all);
    std::vector<Eigen::MatrixXd> out;
    const auto run = [&](auto&& call) {
      try {
        out.emplace_back(call());
      } catch (const Error& e) {
        CHECK(e.code() == ErrorCode::singular);
      }
    };
    run([&] { return rnea(model, data, q, v, x); });
    run([&] { return crba(model, data, q); });
    run([&] { return aba(model, data, q, v, x); });
    run([&] { return computeMinverse(model, data, q); });
    run([&] { return Eigen::MatrixXd(computeJointTorqueRegressor(model, data, q, v, x)); });
    run([&] { return Eigen::MatrixXd::Constant(1, 1, computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q)); });
    run([&] {
      forwardKinematics(model, data, q);
      return toEigen(framePlacement(model, data, static_cast<int>(model.frames().size()) - 1));
    });
    BatchData batch(model, 3, all);
    BatchDataFloat floats(model, 3, all);
    const Eigen::MatrixXd Q = q.replicate(1, 3), V = v.replicate(1, 3), X = x.replicate(1, 3);
    const Eigen::MatrixXf Qf = Q.cast<float>(), Vf = V.cast<float>(), Xf = X.cast<float>();
    run([&] { return Eigen::MatrixXd(rnea(model, batch, Q, V, X)); });
    run([&] { return Eigen::MatrixXd(aba(model, batch, Q, V, X)); });
    run([&] { return Eigen::MatrixXd(rnea(model, floats, Qf, Vf, Xf).template cast<double>()); });
    const ConstraintSet constraints(model);
    ConstraintData rows(constraints);
    run([&] { return Eigen::MatrixXd(constraintDynamics(model, data, q, v, x, rows).ddq); });
    return out;
  };
  const std::vector<Eigen::MatrixXd> first = evaluate(a), second = evaluate(b);
  REQUIRE(first.size() == second.size());
  for (std::size_t k = 0; k < first.size(); ++k) {
    CAPTURE(k);
    CHECK(same(first[k], second[k]));
  }
}

/// Changes all that can change. Centres of mass move so far that some origins of joints move, too.
ModelNumbers scattered(const CompactModel& model, Random& random) {
  ModelNumbers out = model.numbers();
  out.gravity = random.vector(10);
  for (BodyInertia& x : out.inertias) {
    const Vec3<double> com = x.inertia.com;
    x.inertia = random.inertia();
    x.inertia.com = random.below(2) == 0 ? com + x.inertia.com : 3.0 * random.vector();
    if (random.below(9) == 0) x.inertia = {};
  }
  for (std::vector<JointNumbers>* numbers : {&out.damping, &out.friction, &out.armature}) {
    const bool none = random.below(3) == 0;
    for (JointNumbers& x : *numbers)
      for (double& value : x.values) value = none || random.below(3) == 0 ? 0 : random.uniform(0, 1);
  }
  return out;
}
ModelNumbers withLengths(ModelNumbers numbers, Random& random) {
  for (JointPlacement& x : numbers.placements) {
    x.placement.p = random.uniform(0.5, 1.5) * x.placement.p;
    if (random.below(3) == 0) x.placement = random.pose();
  }
  return numbers;
}

/// Returns whether inertias alone moved origins of joints.
bool checkChanges(const Model& description, const CompileOptions& options, std::uint64_t seed) {
  bool moved = false;
  const CompactModel model = compile(description, registry(), options);
  checkSameModel(model, model.withNumbers({}));
  checkSameModel(model, model.withNumbers(model.numbers()));
  checkSameModel(model, model.withInertias(model.numbers().inertias));
  Random random(seed);
  CompactModel chained = model;
  for (int round = 0; round < 3; ++round) {
    CAPTURE(round);
    ModelNumbers numbers = scattered(model, random);
    if (round > 0) numbers = withLengths(numbers, random);
    const CompactModel fresh = compile(changed(description, numbers), registry(), options), quick = model.withNumbers(numbers);
    moved = moved || (round == 0 && quick.impl().user_frame.data() != model.impl().user_frame.data());
    checkSameModel(fresh, quick);
    checkSameResults(fresh, quick, seed);
    chained = chained.withNumbers(numbers);
    checkSameModel(fresh, chained);
  }
  checkSameModel(model, chained.withNumbers(model.numbers()));
  return moved;
}

}  // namespace

TEST_CASE("withNumbers: random trees of all types", "[compile]") {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    CAPTURE(seed);
    Model model = randomTree(registry(), 14, seed, seed % 2 == 0);
    if (seed % 4 == 3) {
      addDependent(model);
      model.bodies.back().joint.damping = {0.4};
    }
    CompileOptions options;
    options.lane_groups = seed % 3 != 0;
    options.armature = seed % 5 != 0;
    options.dissipation = seed % 7 != 0;
    checkChanges(model, options, seed);
  }
}

TEST_CASE("withNumbers: a held joint and a scene", "[compile]") {
  const Model model = treeOf(registry(), {"revolute", "prismatic", "spherical"}, 12, 3);
  CompileOptions options;
  options.lock = {{"j3", {0.3}}};
  const CompactModel compiled = compile(model, registry(), options);
  REQUIRE(!compiled.report().held.empty());
  Random random(4);
  const ModelNumbers numbers = withLengths(scattered(compiled, random), random);
  const CompactModel quick = compiled.withNumbers(numbers);
  checkSameModel(compile(changed(model, numbers), registry(), options), quick);
  CHECK_THROWS_WITH(compiled.withNumbers({.placements = {{options.lock[0].joint, {}}}}), containing("it is held"));

  options.scene.outputs = {model.bodies[2].name};
  options.scene.dynamics = false;
  const CompactModel part = compile(model, registry(), options);
  CHECK_THROWS_WITH(part.withNumbers({.inertias = {{model.bodies.back().name, {}}}}), containing("the model has no body"));
}

TEST_CASE("withNumbers: robots", "[compile]") {
  DYN_NEEDS_SHARED();
  int moved = 0;
  for (const char* robot : {"panda", "talos", "hyq", "icub", "pr2", "tiago", "atlas", "allegro", "baxter"}) {
    CAPTURE(robot);
    LoadOptions options;
    options.root = "free_flyer";
    moved += checkChanges(load(sharedFolder() + "/models/" + robot + ".urdf", options), {}, 5);
  }
  CHECK(moved > 0);
}

TEST_CASE("withNumbers: constraints of a description follow its frames", "[compile]") {
  for (const char* file : {"four_bar.xml", "four_bar.sdf", "arm.urdf", "biped.urdf", "cart.xml"}) {
    CAPTURE(file);
    checkChanges(load(std::string(DYN_SOURCE_DIR) + "/models/" + file), {}, 6);
  }
}

TEST_CASE("withNumbers: models share what is the same", "[compile]") {
  const CompactModel model = compile(randomTree(registry(), 12, 5), registry());
  const CompactModel heavier = model.withNumbers({.inertias = {{"b2", {5, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}}}}});
  CHECK(heavier.joints().data() == model.joints().data());
  CHECK(heavier.frames().data() == model.frames().data());
  CHECK(heavier.mass() != model.mass());
  const CompactModel longer = model.withNumbers({.placements = {{"j2", {Mat3<double>::identity(), {0, 0, 2}}}}});
  CHECK(longer.joints().data() == model.joints().data());
}

TEST_CASE("withNumbers: refuses what compile() refuses", "[compile]") {
  const CompactModel model = compile(randomTree(groups(), 9, 2), registry());
  const auto refused = [&](const ModelNumbers& numbers, ErrorCode code, const char* text) {
    try {
      model.withNumbers(numbers);
      FAIL("accepted where '" << text << "' was expected");
    } catch (const Error& e) {
      CHECK(e.code() == code);
      CHECK_THAT(e.what(), containing(text));
    }
  };
  const Inertia<double> ball{1, {}, {1, 0, 0, 1, 0, 1}};
  Inertia<double> negative = ball, infinite = ball;
  negative.mass = -1;
  infinite.com.y = std::numeric_limits<double>::infinity();
  std::string joint;
  for (const JointRecord& record : model.joints())
    if (record.nv == 1) joint = record.name;
  REQUIRE(!joint.empty());
  refused({.inertias = {{"b1", negative}}}, ErrorCode::model, "body 'b1': its mass is negative");
  refused({.inertias = {{"b1", infinite}}}, ErrorCode::model, "body 'b1': its inertia has an entry that is not finite");
  refused({.inertias = {{"b22", ball}}}, ErrorCode::argument, "the model has no body 'b22'");
  refused({.inertias = {{"", ball}}}, ErrorCode::argument, "the model has no body ''");
  refused({.inertias = {{"tool", ball}}}, ErrorCode::argument, "the model has no body 'tool'");
  refused({.placements = {{"b1", {}}}}, ErrorCode::argument, "the model has no joint 'b1'");
  refused({.placements = {{"j1", {Mat3<double>{}, {}}}}}, ErrorCode::model, "its placement has a matrix that is no rotation");
  refused({.gravity = Vec3<double>{0, std::nan(""), 0}}, ErrorCode::model, "gravity");
  refused({.damping = {{"universe", {1}}}}, ErrorCode::argument, "damping is given for a joint that does not move: 'universe'");
  refused({.friction = {{joint, {1, 2}}}}, ErrorCode::size, "friction has 2 entries, the joint wants 1");
  refused({.friction = {{joint, {}}}}, ErrorCode::size, "friction has no entries, the joint wants 1");
  refused({.armature = {{joint, {-1}}}}, ErrorCode::model, "armature has an entry that is negative or not finite");
  checkSameModel(model, model.withNumbers({}));
}
