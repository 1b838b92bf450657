// SPDX-License-Identifier: BSD-2-Clause
// Sets of constraints that are redundant or contradictory, act on joints or connect trees, and sets that are refused.
#include "constraint/support.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/parsers/urdf.hpp>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

struct State {
  Eigen::VectorXd q, v, tau;
};
State stateOf(const CompactModel& model, std::uint64_t seed) {
  Random random(seed);
  return {integrate(model, neutral(model), random.vector(model.nv(), 1)), random.vector(model.nv(), 1), random.vector(model.nv(), 5)};
}

ConstrainedMotion solve(const CompactModel& model, Data& data, const State& s, ConstraintData& c) {
  return constraintDynamics(model, data, s.q, s.v, s.tau, c);
}

/// Names of the frames of leaf bodies, used as feet.
std::vector<std::string> tips(const CompactModel& model) {
  std::vector<bool> leaf(static_cast<std::size_t>(model.njoints()), true);
  for (const JointRecord& j : model.joints()) leaf[static_cast<std::size_t>(j.parent)] = false;
  std::vector<std::string> out;
  for (std::size_t j = 1; j < leaf.size(); ++j)
    if (leaf[j]) {
      const auto found =
          std::find_if(model.frames().begin(), model.frames().end(), [&](const FrameRecord& f) { return f.joint == static_cast<int>(j); });
      out.push_back(found->name);
    }
  return out;
}

double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) { return (a - b).cwiseAbs().maxCoeff() / (1 + b.cwiseAbs().maxCoeff()); }

}  // namespace

TEST_CASE("contacts that repeat each other change nothing but shares of the force", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 10)));
  const State s = stateOf(model, seed);
  const std::vector<std::string> feet = tips(model);
  REQUIRE(feet.size() >= 2);
  std::vector<ConstraintDescription> once, twice, corners;
  for (std::size_t k = 0; k < 2; ++k) {
    once.push_back(frameContact(feet[k]));
    twice.push_back(frameContact(feet[k]));
    twice.push_back(renamed(frameContact(feet[k]), feet[k] + " again"));
    // Four point contacts on a body constrain it as one frame contact does.
    for (int c = 0; c < 4; ++c) {
      ConstraintDescription corner = renamed(pointContact(feet[k]), feet[k] + std::to_string(c));
      std::get<FrameConstraint>(corner.relation).placement.p = {c < 2 ? 0.1 : -0.1, c % 2 ? 0.05 : -0.05, 0};
      corners.push_back(corner);
    }
  }
  ConstraintData a(ConstraintSet(model, once)), b(ConstraintSet(model, twice)), c(ConstraintSet(model, corners));
  const ConstrainedMotion alone = solve(model, data, s, a);
  const Eigen::VectorXd ddq = alone.ddq, lambda = alone.lambda;
  CHECK(alone.rank == 12);
  for (ConstraintData* redundant : {&b, &c}) {
    // A point contact constrains the acceleration of the point, a frame contact the spatial acceleration. They agree when the feet are at rest.
    State still = s;
    still.v = projectVelocity(model, data, s.q, s.v, a);
    const Eigen::VectorXd wanted = solve(model, data, still, a).ddq;
    const ConstrainedMotion x = solve(model, data, still, *redundant);
    CHECK(x.rank == 12);
    CHECK(x.residual <= 1e-9);
    CHECK(distance(x.ddq, wanted) <= 1e-9);
    CHECK(x.lambda.allFinite());
  }
  const ConstrainedMotion x = solve(model, data, s, b);
  CHECK(distance(x.ddq, ddq) <= 1e-9);
  for (Eigen::Index k = 0; k < 2; ++k) {
    CHECK(distance(2 * x.lambda.segment(12 * k, 6), lambda.segment(6 * k, 6)) <= 1e-9);
    CHECK(distance(2 * x.lambda.segment(12 * k + 6, 6), lambda.segment(6 * k, 6)) <= 1e-9);
  }
}

TEST_CASE("nothing depends on the order of constraints", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 7);
  const std::vector<std::string> feet = tips(model);
  std::vector<ConstraintDescription> set = {frameContact(feet[0]), pointContact(feet[1]), renamed(pointContact(feet[0]), "repeated"),
                                            lockJoint(model.joints().back().name)};
  ConstraintData c(ConstraintSet(model, set));
  const Eigen::VectorXd ddq = solve(model, data, s, c).ddq, lambda = c.set().rows() ? Eigen::VectorXd(solve(model, data, s, c).lambda) : ddq;
  std::vector<std::size_t> order = {0, 1, 2, 3};
  while (std::next_permutation(order.begin(), order.end())) {
    std::vector<ConstraintDescription> other(set.size());
    std::transform(order.begin(), order.end(), other.begin(), [&](std::size_t k) { return set[k]; });
    ConstraintData d(ConstraintSet(model, other));
    const ConstrainedMotion x = solve(model, data, s, d);
    CHECK(distance(x.ddq, ddq) <= 1e-10);
    for (int k = 0; k < 4; ++k) {
      const int original = static_cast<int>(order[static_cast<std::size_t>(k)]);
      CHECK(distance(x.lambda.segment(d.set().firstRow(k), d.set().rows(k)), lambda.segment(c.set().firstRow(original), c.set().rows(original))) <=
            1e-9);
    }
  }
}

TEST_CASE("constraints that contradict each other give least squares and a residual", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 3);
  const std::string foot = tips(model)[0];
  // Constrains one frame twice; the second constraint pulls it to a target where it is not.
  ConstraintDescription pulled = renamed(frameContact(foot), "pulled");
  std::get<FrameConstraint>(pulled.relation).has_target = true;
  pulled.baumgarte = {100, 20};
  ConstraintData c(ConstraintSet(model, {frameContact(foot), pulled}));
  const ConstrainedMotion x = solve(model, data, s, c);
  CHECK(x.rank == 6);
  CHECK(x.residual > 0.1);
  CHECK(x.ddq.allFinite());
  CHECK(x.lambda.cwiseAbs().maxCoeff() < 1e5);
  const DenseRows rows = denseRows(model, data, {frameContact(foot)}, s.q, s.v);
  // Least squares shares the contradiction equally, so the error of the first constraint is the residual.
  const Eigen::VectorXd missed = rows.J * Eigen::VectorXd(solve(model, data, s, c).ddq) + rows.gamma;
  CHECK(std::abs(missed.cwiseAbs().maxCoeff() - solve(model, data, s, c).residual) <= 1e-9 * (1 + missed.cwiseAbs().maxCoeff()));
}

TEST_CASE("proximal iterations find the same motion", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 5);
  const std::vector<std::string> feet = tips(model);
  ConstraintData c(ConstraintSet(model, {frameContact(feet[0]), frameContact(feet[1]), renamed(frameContact(feet[0]), "again")}));
  const Eigen::VectorXd ddq = solve(model, data, s, c).ddq, lambda = solve(model, data, s, c).lambda;
  c.settings.mu = 1e-4;
  for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
    const ConstrainedMotion x = constraintDynamics(model, data, s.q, s.v, s.tau, c, method);
    CHECK(x.iterations > 1);
    CHECK(distance(x.ddq, ddq) <= 1e-8);
    CHECK(distance(x.lambda, lambda) <= 1e-7);
    CHECK(x.residual <= 1e-8);
  }
}

TEST_CASE("a coupling kept by a force moves as one that is taken out of the model", "[constraint]") {
  Model description = randomTree(registry(), 20, 5);
  addDependent(description);
  const CompactModel coupled = compile(description, registry());
  Model free = description;
  const Coupling relation = free.bodies.back().joint.coupling;
  free.bodies.back().joint.coupling = {};
  const CompactModel model = compile(free, registry());
  Data with(coupled, Need::derivatives), data(model, Need::derivatives);
  ConstraintData c(ConstraintSet(model, {coupleJoint("follower", relation)}, &registry()));
  Random random(3);
  const State s{integrate(coupled, neutral(coupled), random.vector(coupled.nv(), 1)), random.vector(coupled.nv(), 1), random.vector(coupled.nv(), 5)};
  // The same state with the dependent joint's coordinate, and no torque on that joint.
  State all{neutral(model), Eigen::VectorXd::Zero(model.nv()), Eigen::VectorXd::Zero(model.nv())};
  int dependent = 0, master = 0;
  for (int j = 1; j < model.njoints(); ++j) {
    const JointRecord& to = model.joints()[static_cast<std::size_t>(j)];
    const JointRecord& from = coupled.joints()[static_cast<std::size_t>(coupled.jointId(to.name))];
    if (to.name == "follower") dependent = to.idx_v;
    if (to.name == relation.master) master = to.idx_v;
    if (from.nv == 0) continue;
    all.q.segment(to.idx_q, to.nq) = s.q.segment(from.idx_q, from.nq);
    all.v.segment(to.idx_v, to.nv) = s.v.segment(from.idx_v, from.nv);
    all.tau.segment(to.idx_v, to.nv) = s.tau.segment(from.idx_v, from.nv);
  }
  all.q[model.joints()[static_cast<std::size_t>(model.jointId("follower"))].idx_q] =
      0.1 + 2 * all.q[model.joints()[static_cast<std::size_t>(model.jointId(relation.master))].idx_q];
  all.v[dependent] = 2 * all.v[master];
  const Eigen::VectorXd wanted = aba(coupled, with, s.q, s.v, s.tau);
  const ConstrainedMotion x = solve(model, data, all, c);
  CHECK(x.residual <= 1e-10);
  for (int j = 1; j < model.njoints(); ++j) {
    const JointRecord& to = model.joints()[static_cast<std::size_t>(j)];
    const JointRecord& from = coupled.joints()[static_cast<std::size_t>(coupled.jointId(to.name))];
    if (from.nv > 0) CHECK(distance(x.ddq.segment(to.idx_v, to.nv), wanted.segment(from.idx_v, from.nv)) <= 1e-9);
  }
  // A model with dependent joints supports contacts, too.
  ConstraintData contact(ConstraintSet(coupled, {pointContact("tool")}));
  const ConstrainedMotion y = constraintDynamics(coupled, with, s.q, s.v, s.tau, contact);
  ConstraintData both(ConstraintSet(model, {pointContact("tool"), coupleJoint("follower", relation)}, &registry()));
  const ConstrainedMotion z = solve(model, data, all, both);
  CHECK(distance(z.lambda.head(3), y.lambda) <= 1e-8);
}

TEST_CASE("a joint locked by a force moves as one that is compiled away", "[constraint]") {
  const std::string joint = "j3";
  const Model description = randomTree(registry(), 10, 21);
  const CompactModel model = compile(description, registry());
  const JointRecord& record = model.joints()[static_cast<std::size_t>(model.jointId(joint))];
  State s = stateOf(model, 2);
  s.v.segment(record.idx_v, record.nv).setZero();
  CompileOptions options;
  const Eigen::VectorXd held = s.q.segment(record.idx_q, record.nq);
  options.lock = {{joint, std::vector<double>(held.data(), held.data() + held.size())}};
  const CompactModel reduced = compile(description, registry(), options);
  const auto without = [&](const Eigen::VectorXd& x, int first, int count) {
    Eigen::VectorXd out(x.size() - count);
    out << x.head(first), x.tail(x.size() - first - count);
    return out;
  };
  Data data(model, Need::derivatives), less(reduced);
  ConstraintData c(ConstraintSet(model, {lockJoint(joint, std::vector<double>(held.data(), held.data() + held.size()))}));
  const Eigen::VectorXd wanted =
      aba(reduced, less, without(s.q, record.idx_q, record.nq), without(s.v, record.idx_v, record.nv), without(s.tau, record.idx_v, record.nv));
  const ConstrainedMotion x = solve(model, data, s, c);
  CHECK(distance(without(x.ddq, record.idx_v, record.nv), wanted) <= 1e-9);
  CHECK(x.ddq.segment(record.idx_v, record.nv).cwiseAbs().maxCoeff() <= 1e-10);
}

TEST_CASE("a flying root that is held falls against what holds it, with and without contacts", "[constraint]") {
  Model description;
  Random random(3);
  int parent = 0;
  for (const char* type : {"free_flyer", "spherical", "spherical", "spherical"}) {
    JointDescription joint;
    joint.name = "joint" + std::to_string(parent);
    joint.type = type;
    joint.placement = random.pose();
    parent = description.addBody("body" + std::to_string(parent), parent, joint, random.inertia());
  }
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 5);
  for (const bool stands : {false, true}) {
    std::vector<ConstraintDescription> set = {lockJoint("joint0")};
    if (stands) set.push_back(pointContact("body3"));
    ConstraintData c(ConstraintSet(model, set));
    const ConstrainedMotion x = constraintDynamics(model, data, s.q, s.v, s.tau, c);
    const Eigen::VectorXd ddq = x.ddq, lambda = x.lambda;
    const ConstrainedMotion by_inertia = constraintDynamics(model, data, s.q, s.v, s.tau, c, ConstraintMethod::kkt);
    CHECK(ddq.head<6>().cwiseAbs().maxCoeff() <= 1e-12 * lambda.cwiseAbs().maxCoeff());
    CHECK(distance(ddq, by_inertia.ddq) <= 1e-11);
    CHECK(distance(lambda, by_inertia.lambda) <= 1e-11);
  }
}

TEST_CASE("two free trees tied together keep their common momentum", "[constraint]") {
  Model description;
  description.gravity = {};
  Random random(11);
  for (int k = 0; k < 2; ++k) {
    JointDescription root;
    root.name = "root" + std::to_string(k);
    root.type = "free_flyer";
    const int body = description.addBody("body" + std::to_string(k), 0, root, random.inertia());
    JointDescription arm;
    arm.name = "arm" + std::to_string(k);
    arm.type = "spherical";
    arm.placement = random.pose();
    description.addBody("hand" + std::to_string(k), body, arm, random.inertia());
  }
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives);
  const auto axes = static_cast<ConstraintAxes>(GENERATE(0, 1, 2));
  ConstraintDescription tie = closeLoop("tie", "hand0", "hand1", {false, false, true, true, false, false});
  std::get<FrameConstraint>(tie.relation).axes = axes;
  std::get<FrameConstraint>(tie.relation).has_target = axes != ConstraintAxes::LOCAL_WORLD_ALIGNED;
  ConstraintData c(ConstraintSet(model, {tie}));
  const State s = stateOf(model, 6);
  const ConstrainedMotion x = constraintDynamics(model, data, s.q, s.v, Eigen::VectorXd::Zero(model.nv()), c);
  const Eigen::VectorXd ddq = x.ddq;
  CHECK(x.residual <= 1e-10);
  const CentroidalRate rate = computeCentroidalMomentumTimeVariation(model, data, s.q, s.v, ddq);
  CHECK(rate.dhg.cwiseAbs().maxCoeff() <= 1e-12 * ddq.cwiseAbs().maxCoeff());
}

TEST_CASE("impacts without restitution take exactly the energy of what they stop", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 8);
  const std::vector<std::string> feet = tips(model);
  ConstraintData c(ConstraintSet(model, {frameContact(feet[0]), pointContact(feet[1])}));
  const double before = computeKineticEnergy(model, data, s.q, s.v);
  const Eigen::VectorXd velocity = computeConstraintMotion(model, data, s.q, s.v, c).velocity;
  const ConstrainedImpact stop = impulseDynamics(model, data, s.q, s.v, 0, c);
  const double loss = -0.5 * stop.impulse.dot(velocity);
  CHECK(std::abs(computeKineticEnergy(model, data, s.q, Eigen::VectorXd(stop.v_after)) - (before - loss)) <= 1e-13 * before);
  const ConstrainedImpact bounce = impulseDynamics(model, data, s.q, s.v, 1, c);
  CHECK(std::abs(computeKineticEnergy(model, data, s.q, Eigen::VectorXd(bounce.v_after)) - before) <= 1e-13 * before);
}

TEST_CASE("Baumgarte's feedback brings a loop back", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const std::string foot = tips(model)[0];
  ConstraintDescription held = frameContact(foot);
  auto& relation = std::get<FrameConstraint>(held.relation);
  relation.has_target = true;
  State s = stateOf(model, 12);
  forwardKinematics(model, data, s.q);
  const SE3<double> pose = framePlacement(model, data, model.frameId(foot));
  relation.other_placement = {pose.R * exp3(Vec3<double>{0.02, -0.03, 0.01}), pose.p + Vec3<double>{0.01, 0.02, -0.01}};
  held.baumgarte = {400, 40};
  relation.axes = static_cast<ConstraintAxes>(GENERATE(0, 1, 2));
  ConstraintData c(ConstraintSet(model, {held}));
  s.v = projectVelocity(model, data, s.q, s.v, c);
  const double start = computeConstraintMotion(model, data, s.q, s.v, c).error.norm();
  CHECK(start > 0.01);
  // Integrates by midpoints. The steps are short, because a robot without torques swings fast.
  const double h = 1e-3;
  const Eigen::VectorXd limp = Eigen::VectorXd::Zero(model.nv());
  for (int k = 0; k < 500; ++k) {
    const Eigen::VectorXd v = s.v + h / 2 * solve(model, data, {s.q, s.v, limp}, c).ddq, q = integrate(model, s.q, Eigen::VectorXd(h / 2 * s.v));
    s.v += h * solve(model, data, {q, v, limp}, c).ddq;
    s.q = integrate(model, s.q, Eigen::VectorXd(h * v));
  }
  CHECK(computeConstraintMotion(model, data, s.q, s.v, c).error.norm() < 0.02 * start);
}

TEST_CASE("a mechanism closes from a guess, or says what it cannot close", "[constraint]") {
  const CompactModel model = biped();
  Data data(model, Need::derivatives);
  const std::vector<std::string> feet = tips(model);
  const State s = stateOf(model, 15);
  forwardKinematics(model, data, s.q);
  ConstraintDescription held = closeLoop("stand", feet[0], "universe");
  std::get<FrameConstraint>(held.relation).other_placement = framePlacement(model, data, model.frameId(feet[0]));
  Random random(4);
  Eigen::VectorXd q = integrate(model, s.q, random.vector(model.nv(), 0.3));
  ConstraintData c(ConstraintSet(model, {held}));
  assemble(model, data, q, c);
  CHECK(computeConstraintMotion(model, data, q, s.v, c).error.cwiseAbs().maxCoeff() <= 1e-14);
  CHECK(projectConfiguration(model, data, q, c).iterations <= 2);

  // The feet cannot be a kilometre apart.
  ConstraintDescription far = closeLoop("far", feet[1], "universe");
  std::get<FrameConstraint>(far.relation).other_placement.p = {1000, 0, 0};
  ConstraintData impossible(ConstraintSet(model, {held, far}));
  const Eigen::VectorXd guess = q;
  CHECK_FALSE(projectConfiguration(model, data, q, impossible).closed);
  CHECK_THROWS_WITH(assemble(model, data, q, impossible), containing("cannot be closed"));
  CHECK(q == guess);
}

TEST_CASE("what makes no constraint is refused by name", "[constraint]") {
  const CompactModel model = biped();
  const std::string foot = tips(model)[0];
  const auto refused = [&](const std::vector<ConstraintDescription>& set) {
    try {
      ConstraintSet(model, set);
    } catch (const Error& e) {
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refused({frameContact("nowhere")}), containing("no body or frame 'nowhere'"));
  CHECK_THAT(refused({frameContact(foot), pointContact(foot)}), containing("two constraints of that name"));
  CHECK_THAT(refused({frameContact(foot, foot)}), containing("belong to one body"));
  CHECK_THAT(refused({lockJoint("nothing")}), containing("no moving joint 'nothing'"));
  CHECK_THAT(refused({lockJoint(model.joints().back().name, {1, 2, 3})}), containing("needs 1 coordinates"));
  CHECK_THAT(refused({coupleJoint(model.joints().back().name, {"mimic", model.joints()[2].name, {}})}), containing("none was given"));
  CHECK_THAT(refused({closeLoop("free", foot, "universe", {true, true, true, true, true, true})}), containing("all directions are free"));
  CHECK_THAT(refused({closeLoop("universal", foot, "universe", {false, false, false, true, true, false})}), containing("two rotations"));
  // The error would be about an axis of the frames, but the rows are about an axis of the world. These axes differ.
  ConstraintDescription hinge = closeLoop("hinge", foot, "universe", {false, true, false, false, true, false});
  std::get<FrameConstraint>(hinge.relation).axes = ConstraintAxes::LOCAL_WORLD_ALIGNED;
  CHECK_THAT(refused({hinge}), containing("use LOCAL or OTHER"));
  ConstraintDescription soft = frameContact(foot);
  soft.baumgarte.velocity = -1;
  CHECK_THAT(refused({soft}), containing("negative"));
  soft.baumgarte = {1, 1};
  CHECK_THAT(refused({soft}), containing("no place to be at"));

  Data data(model, Need::derivatives);
  ConstraintData c(ConstraintSet(model, {frameContact(foot)}));
  const State s = stateOf(model, 1);
  CHECK_THROWS_WITH(constraintDynamics(model, data, s.q, s.v, Eigen::VectorXd::Zero(3), c), containing("tau has 3 entries"));
  CHECK_THROWS_WITH(impulseDynamics(model, data, s.q, s.v, 1.5, c), containing("between 0 and 1"));
  const CompactModel other = biped();
  Data others(other);
  CHECK_THROWS_WITH(constraintDynamics(other, others, s.q, s.v, s.tau, c), containing("another model"));
}

TEST_CASE("an empty set of constraints is no constraint", "[constraint]") {
  const CompactModel model = GENERATE(true, false) ? biped() : compile(urdf::load(DYN_SOURCE_DIR "/models/arm.urdf"), registry());
  Data data(model, Need::derivatives);
  const State s = stateOf(model, 2);
  ConstraintData none((ConstraintSet(model)));
  const Eigen::VectorXd free = aba(model, data, s.q, s.v, s.tau);
  CHECK(distance(solve(model, data, s, none).ddq, free) == 0);
  CHECK(distance(impulseDynamics(model, data, s.q, s.v, 0, none).v_after, s.v) == 0);
}
