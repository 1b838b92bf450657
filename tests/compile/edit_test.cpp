// SPDX-License-Identifier: BSD-2-Clause
// Models made from other models by reduce, keepOnly and append: they keep everything that they should.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/spatial/eigen.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// Three moving links and a fixed one, with everything that a description can contain.
Model arm(std::uint64_t seed) {
  Random random(seed);
  Model model;
  model.name = "arm";
  model.notes = {"a note"};
  const char* types[] = {"revolute", "fixed", "prismatic", "revolute"};
  for (int i = 0; i < 4; ++i) {
    JointDescription joint;
    joint.name = "j" + std::to_string(i);
    joint.type = types[i];
    joint.placement = random.pose();
    if (joint.type != "fixed") {
      joint.parameters["axis"] = std::vector<double>{random.uniform(), 1, random.uniform()};
      joint.limits = {{-1.0 - i}, {1.0 + i}, {2.0 + i}, {10.0 + i}};
      joint.damping = {0.1 * (i + 1)};
      joint.friction = {0.01 * (i + 1)};
      joint.armature = {0.2 * (i + 1)};
    }
    model.addBody("link" + std::to_string(i), i, joint, random.inertia());
  }
  model.addFrame("tool", 4, random.pose());
  return model;
}

/// A hand with a composite joint: a thumb, and a finger that depends on the thumb at half its angle.
Model hand() {
  JointDescription thumb, finger, joint;
  thumb.name = "thumb";
  thumb.type = finger.type = "revolute";
  thumb.parameters["axis"] = finger.parameters["axis"] = std::vector<double>{0, 0, 1};
  finger.name = "finger";
  finger.placement.p = {1, 0, 0};
  finger.coupling = {"mimic", "hand/thumb", {{"coefficients", std::vector<double>{0, 0.5}}}};
  joint.name = "hand";
  joint.type = "composite";
  joint.parameters["parts"] = std::vector<JointDescription>{thumb, finger};
  Model model;
  model.addBody("palm", 0, joint, {1, {0.1, 0, 0}, {1, 0, 0, 1, 0, 1}});
  return model;
}

/// The rotation angle of a body about z at q.
double angleOf(const CompactModel& model, const std::string& body, const Eigen::VectorXd& q) {
  Data data(model);
  forwardKinematics(model, data, q);
  const Mat3<double> R = framePlacement(model, data, model.frameId(body)).R;
  return std::atan2(R(1, 0), R(0, 0));
}

double off(const SE3<double>& a, const SE3<double>& b) { return (toEigen(a) - toEigen(b)).cwiseAbs().maxCoeff(); }

/// Checks that M, rnea and every frame of `part` equal those of `whole`, joint by joint, while joints that `part` lacks are held at held_q.
void checkSame(const CompactModel& whole, const CompactModel& part, const Eigen::VectorXd& held_q, const std::string& prefix = "") {
  Random random(77);
  Data wd(whole, Need::mass_matrix), pd(part, Need::mass_matrix);
  const Eigen::VectorXd pq = integrate(part, neutral(part), Eigen::VectorXd(random.vector(part.nv(), 1))), pv = random.vector(part.nv(), 1),
                        pa = random.vector(part.nv(), 1);
  Eigen::VectorXd wq = held_q, wv = Eigen::VectorXd::Zero(whole.nv()), wa = wv;
  std::vector<int> rows;
  for (const JointRecord& p : part.joints()) {
    if (p.nv == 0) continue;
    const int id = whole.jointId(prefix + p.name);
    REQUIRE(id > 0);
    const JointRecord& w = whole.joints()[static_cast<std::size_t>(id)];
    REQUIRE(w.nv == p.nv);
    wq.segment(w.idx_q, w.nq) = pq.segment(p.idx_q, p.nq);
    wv.segment(w.idx_v, w.nv) = pv.segment(p.idx_v, p.nv);
    wa.segment(w.idx_v, w.nv) = pa.segment(p.idx_v, p.nv);
    for (int k = 0; k < w.nv; ++k) {
      const auto at = [](int i) { return static_cast<std::size_t>(i); };
      rows.push_back(w.idx_v + k);
      CHECK(whole.limits().lower[at(w.idx_q + k)] == part.limits().lower[at(p.idx_q + k)]);
      CHECK(whole.limits().upper[at(w.idx_q + k)] == part.limits().upper[at(p.idx_q + k)]);
      CHECK(whole.limits().velocity[at(w.idx_v + k)] == part.limits().velocity[at(p.idx_v + k)]);
      CHECK(whole.limits().effort[at(w.idx_v + k)] == part.limits().effort[at(p.idx_v + k)]);
    }
  }
  const Eigen::VectorXd wtau = rnea(whole, wd, wq, wv, wa), ptau = rnea(part, pd, pq, pv, pa);
  const Eigen::MatrixXd wM = crba(whole, wd, wq), pM = crba(part, pd, pq);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    CHECK(ptau[k] == approx(wtau[rows[i]]).epsilon(1e-12).margin(1e-12));
    for (std::size_t j = 0; j < rows.size(); ++j)
      CHECK(pM(k, static_cast<Eigen::Index>(j)) == approx(wM(rows[i], rows[j])).epsilon(1e-12).margin(1e-12));
  }
  forwardKinematics(whole, wd, wq);
  forwardKinematics(part, pd, pq);
  for (const FrameRecord& f : part.frames()) {
    if (f.name == "universe") continue;
    REQUIRE(whole.frameId(prefix + f.name) >= 0);
    CHECK(off(framePlacement(whole, wd, whole.frameId(prefix + f.name)), framePlacement(part, pd, part.frameId(f.name))) < 1e-14);
  }
}

}  // namespace

TEST_CASE("a held joint leaves the model; its body, frames and mass stay, and the other joints keep all they had", "[edit]") {
  const Model model = arm(1);
  const CompactModel whole = compile(model, registry());
  const CompactModel reduced = compile(reduce(model, registry(), {{"j2", {0.3}}}), registry());
  CHECK(reduced.nv() == 2);
  CHECK(reduced.mass() == approx(whole.mass()).epsilon(1e-15));
  CHECK(reduced.frames().size() == whole.frames().size());
  Eigen::VectorXd held = Eigen::VectorXd::Zero(3);
  held[1] = 0.3;
  checkSame(whole, reduced, held);

  CompileOptions options;
  options.lock = {{"j2", {0.3}}};
  const CompactModel locked = compile(model, registry(), options);
  CHECK(locked.nv() == 2);
  checkSame(whole, locked, held);
}

TEST_CASE("keepOnly holds all others at neutral, and keeps masters with their followers", "[edit]") {
  Model model = arm(2);
  const CompactModel whole = compile(model, registry());
  checkSame(whole, compile(keepOnly(model, registry(), {"j0", "j3"}), registry()), Eigen::VectorXd::Zero(3));
  model.bodies[4].joint.coupling = {"mimic", "j0", {{"coefficients", std::vector<double>{0.1, 2}}}};
  const CompactModel dependent = compile(keepOnly(model, registry(), {"j3"}), registry());
  CHECK(dependent.nv() == 1);
  CHECK(dependent.joints()[1].name == "j0");
  CHECK(dependent.jointId("j3") > 0);
}

TEST_CASE("followers of a held joint are held where it puts them", "[edit]") {
  Model model = arm(3);
  model.bodies[4].joint.coupling = {"mimic", "j0", {{"coefficients", std::vector<double>{0.1, 2, 0.5}}}};
  const CompactModel held = compile(reduce(model, registry(), {{"j0", {0.4}}}), registry());
  CHECK(held.nv() == 1);
  Model free = arm(3);
  const CompactModel whole = compile(free, registry());
  Eigen::VectorXd q = Eigen::VectorXd::Zero(3);
  q[0] = 0.4;
  q[2] = 0.1 + 2 * 0.4 + 0.5 * 0.16;
  checkSame(whole, held, q);
}

TEST_CASE("a follower that is named itself is held where it is said, whichever comes first", "[edit]") {
  Model model = arm(3);
  model.bodies[4].joint.coupling = {"mimic", "j0", {{"coefficients", std::vector<double>{0.1, 2}}}};
  const CompactModel whole = compile(arm(3), registry());
  Eigen::VectorXd q = Eigen::VectorXd::Zero(3);
  q[0] = 0.5;
  q[2] = -0.25;
  checkSame(whole, compile(reduce(model, registry(), {{"j0", {0.5}}, {"j3", {-0.25}}}), registry()), q);
  checkSame(whole, compile(reduce(model, registry(), {{"j3", {-0.25}}, {"j0", {0.5}}}), registry()), q);
}

TEST_CASE("joints of every kind can be held anywhere", "[edit]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 6)));
  const Model model = randomTree(registry(), 12, seed);
  const CompactModel whole = compile(model, registry());
  Random random(seed);
  const Eigen::VectorXd q = integrate(whole, neutral(whole), Eigen::VectorXd(random.vector(whole.nv(), 0.7)));
  std::vector<LockedJoint> lock;
  for (const JointRecord& r : whole.joints())
    if (r.nv > 0 && random.below(2) == 0) lock.push_back({r.name, std::vector<double>(q.data() + r.idx_q, q.data() + r.idx_q + r.nq)});
  checkSame(whole, compile(reduce(model, registry(), lock), registry()), q);
}

TEST_CASE("what cannot be held is refused by name, and the model is untouched", "[edit]") {
  const Model model = arm(4);
  CHECK_THROWS_WITH(reduce(model, registry(), {{"nobody", {}}}), containing("'nobody'"));
  CHECK_THROWS_WITH(reduce(model, registry(), {{"j2", {1, 2}}}), containing("'j2'") && containing("1 coordinates"));
  CHECK_THROWS_WITH(reduce(model, registry(), {{"j2", {0.5}}, {"j2", {0.5}}}), containing("'j2'") && containing("twice"));
  CHECK_THROWS_WITH(keepOnly(model, registry(), {"nobody"}), containing("'nobody'"));
  CHECK_THROWS_WITH(keepOnly(model, registry(), {"jj2"}), containing("'jj2'") && containing("did you mean") && containing("'j2'"));
  CHECK(compile(model, registry()).nv() == 3);
}

TEST_CASE("an appended model moves on its carrier as it moves alone, and keeps all it had", "[edit]") {
  const Model base = arm(5), tool = arm(6);
  Random random(8);
  const SE3<double> P = random.pose();
  const CompactModel both = compile(append(base, tool, "tool", P, "tool_"), registry());
  CHECK(both.nv() == 6);
  CHECK(both.mass() == approx(compile(base, registry()).mass() + compile(tool, registry()).mass()).epsilon(1e-14));
  // The appended model alone, placed by hand where the carrier's frame is when the first arm is at neutral.
  const CompactModel alone = compile(base, registry());
  Data data(alone);
  forwardKinematics(alone, data, neutral(alone));
  const SE3<double> carrier = framePlacement(alone, data, alone.frameId("tool")) * P;
  Model moved = tool;
  moved.bodies[1].joint.placement = carrier * moved.bodies[1].joint.placement;
  checkSame(both, compile(moved, registry()), neutral(both), "tool_");
  CHECK(append(base, tool, "link3", {}, "x_").notes.size() == 2);
}

TEST_CASE("couplings of an appended model follow its own joints", "[edit]") {
  Model tool = arm(6);
  tool.bodies[4].joint.coupling = {"mimic", "j0", {{"coefficients", std::vector<double>{0, 1}}}};
  const Model both = append(arm(5), tool, "link3", {}, "tool_");
  CHECK(both.bodies.back().joint.coupling.master == "tool_j0");
  CHECK(compile(both, registry()).nv() == 5);
}

TEST_CASE("append refuses carriers that do not exist and names that would be there twice", "[edit]") {
  CHECK_THROWS_WITH(append(arm(1), arm(2), "nobody", {}, "x_"), containing("'nobody'"));
  CHECK_THROWS_WITH(append(arm(1), arm(2), "tool"), containing("twice"));
}

TEST_CASE("couplings of an appended joint's parts follow its own parts", "[edit]") {
  for (const std::string prefix : {"left_", "right_"}) {
    const Model one = append(Model(), hand(), "universe", {}, prefix);
    CHECK(angleOf(compile(one, registry()), prefix + "palm", Eigen::VectorXd::Ones(1)) == approx(1.5));
  }
  const CompactModel both = compile(append(hand(), hand(), "universe", {}, "second_"), registry());
  REQUIRE(both.nv() == 2);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(2);
  q[both.joints()[static_cast<std::size_t>(both.jointId("hand"))].idx_q] = 1;
  CHECK(angleOf(both, "palm", q) == approx(1.5));
  CHECK(angleOf(both, "second_palm", q) == approx(0).margin(1e-15));
}

TEST_CASE("parts that follow a held joint are held where it puts them, and the other parts keep all they had", "[edit]") {
  // The hand is mounted on an arm. Its finger depends on the arm's j0; its thumb is free.
  Model model = append(arm(3), hand(), "link3");
  JointDescription& joint = model.bodies.back().joint;
  auto& parts = std::get<std::vector<JointDescription>>(joint.parameters.at("parts"));
  parts[1].coupling.master = "j0";
  joint.limits.lower = {-1, -2};
  joint.limits.upper = {1, 2};
  joint.damping = {0.1, 0.2};
  const CompactModel held = compile(reduce(model, registry(), {{"j0", {0.4}}}), registry());
  CHECK(held.nv() == 3);
  parts[1].coupling = {};
  const CompactModel whole = compile(model, registry());
  Eigen::VectorXd at = Eigen::VectorXd::Zero(whole.nq()), rest = Eigen::VectorXd::Zero(held.nq());
  const auto first = [](const CompactModel& m, const char* name) { return m.joints()[static_cast<std::size_t>(m.jointId(name))].idx_q; };
  at[first(whole, "j0")] = 0.4;
  at[first(whole, "hand")] = rest[first(held, "hand")] = 0.7;
  at[first(whole, "hand") + 1] = 0.2;
  Data wd(whole), hd(held);
  forwardKinematics(whole, wd, at);
  forwardKinematics(held, hd, rest);
  CHECK(off(framePlacement(whole, wd, whole.frameId("palm")), framePlacement(held, hd, held.frameId("palm"))) < 1e-14);
  CHECK(held.limits().lower[static_cast<std::size_t>(first(held, "hand"))] == -1);
}

TEST_CASE("a joint with parts that follow others is held by itself", "[edit]") {
  const CompactModel held = compile(reduce(hand(), registry(), {{"hand", {1}}}), registry());
  CHECK(held.nv() == 0);
  CHECK(angleOf(held, "palm", Eigen::VectorXd(0)) == approx(1.5));
  CHECK_THROWS_WITH(reduce(hand(), registry(), {{"hand", {1, 2}}}), containing("1 coordinates"));
}

TEST_CASE("a held joint that follows another one, or a part of which does, is held where neutral has it", "[edit]") {
  const auto following = [](double offset) { return Coupling{"mimic", "j0", {{"coefficients", std::vector<double>{offset, 0.3}}}}; };
  Model with_part = append(arm(3), hand(), "link3"), whole_joint = arm(4);
  std::get<std::vector<JointDescription>>(with_part.bodies.back().joint.parameters.at("parts"))[1].coupling = following(0.5);
  whole_joint.bodies.back().joint.coupling = following(-0.8);
  const std::string last = whole_joint.bodies.back().joint.name;
  for (const auto& [model, joint] : {std::pair<const Model&, std::string>{with_part, "hand"}, {whole_joint, last}}) {
    const CompactModel whole = compile(model, registry()), held = compile(reduce(model, registry(), {{joint, {}}}), registry());
    Data wd(whole), hd(held);
    forwardKinematics(whole, wd, neutral(whole));
    forwardKinematics(held, hd, neutral(held));
    const std::string& body = model.bodies.back().name;
    CHECK(off(framePlacement(whole, wd, whole.frameId(body)), framePlacement(held, hd, held.frameId(body))) < 1e-14);
  }
  // Only the thumb's coordinate is in the model's q. The finger depends on j0, which is held, too.
  const CompactModel whole = compile(with_part, registry()),
                     held = compile(reduce(with_part, registry(), {{"hand", {0.7}}, {"j0", {0.4}}}), registry());
  Eigen::VectorXd at = neutral(whole);
  at[whole.joints()[static_cast<std::size_t>(whole.jointId("hand"))].idx_q] = 0.7;
  at[whole.joints()[static_cast<std::size_t>(whole.jointId("j0"))].idx_q] = 0.4;
  Data wd(whole), hd(held);
  forwardKinematics(whole, wd, at);
  forwardKinematics(held, hd, neutral(held));
  CHECK(off(framePlacement(whole, wd, whole.frameId("palm")), framePlacement(held, hd, held.frameId("palm"))) < 1e-14);
}

TEST_CASE("keepOnly keeps what parts of a kept joint follow, and holds joints with such parts", "[edit]") {
  Model model = append(arm(3), hand(), "link3");
  std::get<std::vector<JointDescription>>(model.bodies.back().joint.parameters.at("parts"))[1].coupling.master = "j0";
  const CompactModel kept = compile(keepOnly(model, registry(), {"hand"}), registry());
  CHECK(kept.nv() == 2);
  CHECK(compile(keepOnly(model, registry(), {"j3"}), registry()).nv() == 1);
  // a_j3 depends on a part of the hand's joint.
  Model other = append(hand(), arm(3), "universe", {}, "a_");
  other.bodies.back().joint.coupling = {"mimic", "hand/thumb", {{"coefficients", std::vector<double>{0, 1}}}};
  CHECK(compile(keepOnly(other, registry(), {"a_j3"}), registry()).nv() == 1);
  CHECK(compile(reduce(other, registry(), {{"hand", {0.5}}}), registry()).nv() == 2);
}

TEST_CASE("collisions that an appended model disables with its world are disabled with what hung there, not with what carries it", "[edit]") {
  Model tool = arm(6);
  tool.addGeometry("mount", 0, {}, geometry::Sphere{0.1});
  tool.disabled_collisions = {{"universe", "link2", "Adjacent"}, {"link1", "link2", "Never"}};
  const Model both = append(arm(5), tool, "tool", {}, "x_");
  REQUIRE(both.disabled_collisions.size() == 2);
  CHECK(both.disabled_collisions[0].body == "x_mount");
  CHECK(both.disabled_collisions[0].other == "x_link2");
  CHECK(both.disabled_collisions[1].body == "x_link1");
  CHECK(compile(both, registry()).report().warnings.empty());
}

TEST_CASE("a disabled collision of a body that is not there is reported", "[edit]") {
  Model model = arm(5);
  model.disabled_collisions = {{"link0", "nobody", ""}};
  const CompactModel compact = compile(model, registry());
  const auto& warnings = compact.report().warnings;
  REQUIRE(warnings.size() == 1);
  CHECK_THAT(warnings[0], containing("no body or volume 'nobody'"));
}
