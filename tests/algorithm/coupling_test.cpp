// SPDX-License-Identifier: BSD-2-Clause
// Dependent joints and composite joints: their mechanics equal those of the joints that they stand for.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn_sdk/joint_plugin.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

JointDescription jointOf(const std::string& name, const std::string& type, Random& random) {
  JointDescription joint;
  joint.name = name;
  joint.type = type;
  const Vec3<double> n = random.vector();
  joint.parameters["axis"] = std::vector<double>{n.x, n.y, n.z};
  joint.placement = random.pose();
  joint.damping = {random.uniform(0, 1)};
  joint.armature = {random.uniform(0, 0.1)};
  return joint;
}

/// A chain a - b - c - d with a branch e. If `coupled`, c depends on a by a polynomial and d depends on c; e is free.
Model coupledModel(bool coupled, std::uint64_t seed) {
  Random random(seed);
  Model model;
  const char* types[] = {"revolute", "continuous", "prismatic", "revolute", "revolute"};
  const char* names[] = {"a", "b", "c", "d", "e"};
  const int parents[] = {0, 1, 2, 3, 2};
  for (int i = 0; i < 5; ++i) {
    JointDescription joint = jointOf(names[i], types[i], random);
    if (coupled && joint.name == "c") joint.coupling = {"mimic", "a", {{"coefficients", std::vector<double>{0.1, 0.5, -0.3}}}};
    if (coupled && joint.name == "d") joint.coupling = {"mimic", "c", {{"coefficients", std::vector<double>{-0.2, 2.0}}}};
    model.addBody(joint.name + "_link", parents[i], joint, random.inertia());
  }
  return model;
}

}  // namespace

TEST_CASE("a coupled model is the free one moved along its couplings", "[coupling]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 8)));
  const CompactModel free = compile(coupledModel(false, seed), registry()), coupled = compile(coupledModel(true, seed), registry());
  REQUIRE(free.nv() == 5);
  REQUIRE(coupled.nv() == 3);  // a, b, e
  Data free_data(free, Need::mass_matrix), data(coupled, Need::mass_matrix);
  Random random(seed + 50);
  const Eigen::VectorXd t = random.vector(3, 1), v = random.vector(3, 1), a = random.vector(3, 1), tau = random.vector(3, 3);
  const Eigen::VectorXd q = integrate(coupled, neutral(coupled), t);
  // c = 0.1 + 0.5 x - 0.3 x^2 with x = a; d = -0.2 + 2 c.
  const double x = t[0], c = 0.1 + 0.5 * x - 0.3 * x * x, dc = 0.5 - 0.6 * x, ddc = -0.6;
  Eigen::VectorXd tangent(5);
  tangent << x, t[1], c, -0.2 + 2 * c, t[2];
  const Eigen::VectorXd fq = integrate(free, neutral(free), tangent);
  Eigen::MatrixXd G = Eigen::MatrixXd::Zero(5, 3);
  G << 1, 0, 0, 0, 1, 0, dc, 0, 0, 2 * dc, 0, 0, 0, 0, 1;
  Eigen::VectorXd gamma = Eigen::VectorXd::Zero(5);
  gamma[2] = ddc * v[0] * v[0];
  gamma[3] = 2 * gamma[2];
  const Eigen::VectorXd fv = G * v, fa = G * a + gamma;

  const Eigen::MatrixXd M = G.transpose() * crba(free, free_data, fq) * G;
  CHECK((M - crba(coupled, data, q)).norm() < 1e-12 * M.norm());
  const Eigen::VectorXd expected = G.transpose() * rnea(free, free_data, fq, fv, fa);
  CHECK((expected - rnea(coupled, data, q, v, a)).norm() < 1e-12 * (1 + expected.norm()));
  const Eigen::VectorXd ddq = aba(coupled, data, q, v, tau);
  CHECK((rnea(coupled, data, q, v, ddq) - tau).norm() < 1e-10 * (1 + tau.norm()));

  const int frame = coupled.frameId("d_link");
  Eigen::MatrixXd J(6, 3), dJ(6, 3), fJ(6, 5), fdJ(6, 5);
  for (const auto reference : {ReferenceFrame::LOCAL, ReferenceFrame::WORLD, ReferenceFrame::LOCAL_WORLD_ALIGNED}) {
    computeFrameJacobian(coupled, data, q, frame, reference, J);
    computeFrameJacobian(free, free_data, fq, free.frameId("d_link"), reference, fJ);
    CHECK((J - fJ * G).norm() < 1e-12 * fJ.norm());
    computeFrameJacobianTimeVariation(coupled, data, q, v, frame, reference, dJ);
    computeFrameJacobianTimeVariation(free, free_data, fq, fv, free.frameId("d_link"), reference, fdJ);
    Eigen::MatrixXd dG = Eigen::MatrixXd::Zero(5, 3);
    dG(2, 0) = ddc * v[0];
    dG(3, 0) = 2 * ddc * v[0];
    CHECK((dJ - fdJ * G - fJ * dG).norm() < 1e-12 * (1 + fdJ.norm()));
  }
  CHECK(computeKineticEnergy(coupled, data, q, v) == approx(0.5 * v.dot(M * v)).epsilon(1e-12));
  const Eigen::MatrixXd Jcom = jacobianCenterOfMass(coupled, data, q), fJcom = jacobianCenterOfMass(free, free_data, fq);
  CHECK((Jcom - fJcom * G).norm() < 1e-12 * fJcom.norm());
}

namespace {

/// A slide whose neutral position is 0.3 m, in a vector space otherwise.
struct OffsetSlide : dyn::sdk::Joint<OffsetSlide, 1> {
  static constexpr const char* name = "offset_slide";
  static constexpr const char* summary = "a slide whose neutral position is 0.3 m";
  static void neutral(double* q) { *q = 0.3; }
  template <class S>
  static SE3<S> pose(const S* q, const dyn::sdk::Constants&) {
    SE3<S> X;
    X.p.x = q[0];
    return X;
  }
};

}  // namespace

TEST_CASE("a dependent joint moves by its coupling from its neutral position, whatever that is", "[coupling]") {
  static const dyn::sdk::JointTypeOf<OffsetSlide> type;
  JointRegistry mine = JointRegistry::standard();
  mine.add(type);
  Model model;
  JointDescription master, slide;
  master.name = "master";
  master.type = "prismatic";
  master.parameters["axis"] = std::vector<double>{0, 0, 1};
  slide.name = "slide";
  slide.type = "offset_slide";
  slide.coupling = {"mimic", "master", {{"coefficients", std::vector<double>{0.1, 0.5}}}};
  model.addBody("lift", 0, master, {1, {}, {1, 0, 0, 1, 0, 1}});
  model.addBody("tip", 1, slide, {1, {}, {1, 0, 0, 1, 0, 1}});
  const CompactModel compact = compile(model, mine);
  Data data(compact);
  forwardKinematics(compact, data, Eigen::VectorXd::Constant(1, 0.8));
  CHECK(framePlacement(compact, data, compact.frameId("tip")).p.x == approx(0.3 + 0.1 + 0.5 * 0.8));
}

TEST_CASE("couplings in a circle and couplings to nothing are refused by name", "[coupling]") {
  Model model = coupledModel(true, 1);
  SECTION("circle") {
    model.bodies[1].joint.coupling = {"mimic", "d", {{"coefficients", std::vector<double>{0, 1}}}};
    CHECK_THROWS_WITH(compile(model, registry()), containing("circle"));
  }
  SECTION("no such master") {
    model.bodies[3].joint.coupling.master = "nobody";
    CHECK_THROWS_WITH(compile(model, registry()), containing("'c'") && containing("'nobody'"));
  }
}

TEST_CASE("a composite joint moves as its parts one after the other", "[composite]") {
  Random random(3);
  std::vector<JointDescription> parts(3);
  const char* types[] = {"revolute", "prismatic", "spherical"};
  for (std::size_t i = 0; i < 3; ++i) {
    parts[i].type = types[i];
    if (i < 2) parts[i].parameters["axis"] = std::vector<double>{random.uniform(), 1, random.uniform()};
    parts[i].placement = random.pose();
  }
  const Inertia<double> Y = random.inertia();
  Model composite, chain;
  JointDescription joint;
  joint.name = "j";
  joint.type = "composite";
  joint.placement = random.pose();
  joint.parameters["parts"] = parts;
  joint.damping = {0.1, 0.2, 0.3, 0.4, 0.5};
  composite.addBody("tip", 0, joint, Y);
  for (std::size_t i = 0; i < 3; ++i) {
    JointDescription part = parts[i];
    part.name = "p" + std::to_string(i);
    if (i == 0) part.placement = joint.placement * part.placement;
    part.damping = i == 0 ? std::vector<double>{0.1} : (i == 1 ? std::vector<double>{0.2} : std::vector<double>{0.3, 0.4, 0.5});
    chain.addBody(i == 2 ? "tip" : "link" + std::to_string(i), static_cast<int>(i), part, i == 2 ? Y : Inertia<double>{});
  }
  const CompactModel a = compile(composite, registry()), b = compile(chain, registry());
  REQUIRE(a.nq() == 6);
  REQUIRE(a.nv() == 5);
  REQUIRE(a.njoints() == 2);
  CHECK(a.joints()[1].name == "j");
  Data da(a, Need::mass_matrix), db(b, Need::mass_matrix);
  const Eigen::VectorXd q = integrate(a, neutral(a), random.vector(5, 1)), v = random.vector(5, 1), acc = random.vector(5, 1);
  CHECK((rnea(a, da, q, v, acc) - rnea(b, db, q, v, acc)).norm() < 1e-14);
  CHECK((crba(a, da, q) - crba(b, db, q)).norm() < 1e-14);
}
