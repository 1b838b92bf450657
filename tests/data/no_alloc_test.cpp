// SPDX-License-Identifier: BSD-2-Clause
// No algorithm allocates once Data exists. The test watches malloc itself, because Eigen does not use operator new.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/shared.hpp"
#include "support/skip.hpp"

#include <dyn/parsers/urdf.hpp>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {
template <class F>
long allocationsOf(F&& f) {
  const long before = tool::allocationCount();
  f();
  return tool::allocationCount() - before;
}
}  // namespace

TEST_CASE("the watch sees an allocation by Eigen", "[no_alloc]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  double* volatile keep = nullptr;
  CHECK(allocationsOf([&] {
          Eigen::VectorXd x(100);
          keep = x.data();
        }) > 0);
}

TEST_CASE("no algorithm allocates once Data exists", "[no_alloc]") {
  const JointRegistry registry = JointRegistry::standard();
  const bool coupled = GENERATE(false, true);
  Model description = randomTree(registry, 25, 5, true);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry);
  Data data(model, Need::derivatives);
  const Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd::Constant(model.nv(), 0.7));
  const Eigen::VectorXd v = Eigen::VectorXd::Constant(model.nv(), 0.2), a = v, tau = v;
  Eigen::MatrixXd J(6, model.nv()), other(6, model.nv());
  const int tool = model.frameId("tool");
  Eigen::MatrixXd stacked(12, model.nv()), square = Eigen::MatrixXd::Identity(model.nv(), model.nv());
  Eigen::VectorXd next(model.nq()), dv(model.nv());
  const ExternalForces fext(model.joints().size());

  CHECK(allocationsOf([&] { forwardKinematics(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { framePlacement(model, data, tool); }) == 0);
  CHECK(allocationsOf([&] { rnea(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { rnea(model, data, q, v, a, fext); }) == 0);
  CHECK(allocationsOf([&] { nonLinearEffects(model, data, q, v); }) == 0);
  CHECK(allocationsOf([&] { generalizedGravity(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { crba(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { aba(model, data, q, v, tau); }) == 0);
  CHECK(allocationsOf([&] { centerOfMass(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { jacobianCenterOfMass(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeKineticEnergy(model, data, q, v); }) == 0);
  CHECK(allocationsOf([&] { computePotentialEnergy(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeFrameJacobian(model, data, q, tool, ReferenceFrame::LOCAL, J); }) == 0);
  CHECK(allocationsOf([&] { computeFrameJacobianTimeVariation(model, data, q, v, tool, ReferenceFrame::WORLD, J); }) == 0);
  CHECK(allocationsOf([&] { getJointJacobian(model, data, 1, ReferenceFrame::LOCAL, stacked.topRows(6)); }) == 0);
  if (!coupled) CHECK(allocationsOf([&] { computeJointJacobians(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeRNEADerivatives(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { computeABADerivatives(model, data, q, v, tau, fext); }) == 0);
  CHECK(allocationsOf([&] { computeGeneralizedGravityDerivatives(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeMinverse(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeCoriolisMatrix(model, data, q, v); }) == 0);
  CHECK(allocationsOf([&] { ccrba(model, data, q, v); }) == 0);
  CHECK(allocationsOf([&] { computeCentroidalMomentumTimeVariation(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { computeCentroidalDynamicsDerivatives(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { computeCenterOfMassDerivatives(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { computeJointTorqueRegressor(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { computeKineticEnergyRegressor(model, data, q, v); }) == 0);
  CHECK(allocationsOf([&] { computePotentialEnergyRegressor(model, data, q); }) == 0);
  CHECK(allocationsOf([&] { computeForwardKinematicsDerivatives(model, data, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { getFrameVelocityDerivatives(model, data, tool, ReferenceFrame::LOCAL, J, other); }) == 0);
  CHECK(allocationsOf([&] {
          getJointAccelerationDerivatives(model, data, 3, ReferenceFrame::LOCAL_WORLD_ALIGNED, J, other, stacked.topRows(6), stacked.bottomRows(6));
        }) == 0);
  const Quantity derived = Quantity::rnea | Quantity::nle | Quantity::gravity | Quantity::mass_matrix | Quantity::minverse | Quantity::coriolis |
                           Quantity::centroidal_map | Quantity::centroidal_rate | Quantity::rnea_derivatives;
  CHECK(allocationsOf([&] { compute(model, data, Quantity::accelerations | Quantity::center_of_mass | Quantity::energies, q, v, a); }) == 0);
  CHECK(allocationsOf([&] { compute(model, data, derived, q, v, a); }) == 0);
  if (!coupled) {
    SecondDerivativeData second(model);
    Eigen::VectorXd x = tau;
    CHECK(allocationsOf([&] { compute(model, data, derived | Quantity::joint_jacobians, q, v, a); }) == 0);
    CHECK(allocationsOf([&] { computeRNEASecondOrderDerivatives(model, data, second, q, v, a); }) == 0);
    CHECK(allocationsOf([&] { forwardDynamics(model, data, q, v, tau); }) == 0);
    CHECK(allocationsOf([&] { cholesky::decompose(model, data); }) == 0);
    CHECK(allocationsOf([&] { cholesky::solve(model, data, square); }) == 0);
    CHECK(allocationsOf([&] { cholesky::Mv(model, data, square); }) == 0);
    CHECK(allocationsOf([&] { cholesky::Uv(model, data, x); }) == 0);
    CHECK(allocationsOf([&] { cholesky::Utv(model, data, x); }) == 0);
  }
  CHECK(allocationsOf([&] { integrate(model, q, v, next); }) == 0);
  CHECK(allocationsOf([&] { difference(model, q, next, dv); }) == 0);
  CHECK(allocationsOf([&] { normalize(model, next, next); }) == 0);
  CHECK(allocationsOf([&] { dIntegrate(model, q, v, ArgumentPosition::ARG1, square); }) == 0);
  CHECK(allocationsOf([&] { dDifference(model, q, next, ArgumentPosition::ARG0, square); }) == 0);
}

TEST_CASE("no algorithm of constraints allocates once their data exists", "[no_alloc]") {
  const JointRegistry registry = JointRegistry::standard();
  const bool coupled = GENERATE(false, true);
  Model description = randomTree(registry, 25, 5, true);
  if (coupled) addDependent(description);
  const CompactModel model = compile(description, registry);
  Data data(model, Need::derivatives);
  ConstraintDescription target = closeLoop("target", "b20", "b4", {false, false, false, false, false, true});
  target.baumgarte = {10, 5};
  ConstraintDescription twice = pointContact("tool");
  twice.name = "tool again";
  const bool singular = GENERATE(false, true);
  // The name is too long for a string without allocation. Messages that nobody reads must not be composed.
  ConstraintDescription contact = pointContact("tool");
  contact.name = "the contact of the tool with the world";
  std::vector<ConstraintDescription> set = {contact, target, lockJoint(model.joints()[2].name)};
  if (singular) set.push_back(twice);
  ConstraintData c(ConstraintSet(model, set), Need::derivatives);
  Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd::Constant(model.nv(), 0.7));
  const Eigen::VectorXd v = Eigen::VectorXd::Constant(model.nv(), 0.2), tau = v;
  const std::vector<FrictionCone> cones = {{0, 0.5}};
  Eigen::VectorXd rows = Eigen::VectorXd::Ones(c.set().rows());

  CHECK(allocationsOf([&] { constraintDynamics(model, data, q, v, tau, c); }) == 0);
  CHECK(allocationsOf([&] { constraintDynamics(model, data, q, v, tau, c, ConstraintMethod::kkt); }) == 0);
  CHECK(allocationsOf([&] { impulseDynamics(model, data, q, v, 0.5, c); }) == 0);
  CHECK(allocationsOf([&] { computeConstraintMotion(model, data, q, v, c); }) == 0);
  CHECK(allocationsOf([&] { computeConstraintJacobian(model, data, q, c); }) == 0);
  CHECK(allocationsOf([&] { computeConstraintDynamicsDerivatives(model, data, q, v, tau, c); }) == 0);
  CHECK(allocationsOf([&] { computeImpulseDynamicsDerivatives(model, data, q, v, 0.5, c); }) == 0);
  CHECK(allocationsOf([&] { computeDelassusMatrix(model, data, q, c); }) == 0);
  CHECK(allocationsOf([&] { computeOperationalSpaceInertia(model, data, q, c); }) == 0);
  CHECK(allocationsOf([&] { DelassusOperator(model, data, q, c).apply(rows, rows); }) == 0);
  CHECK(allocationsOf([&] { contactStep(model, data, q, v, tau, 1e-3, c, cones); }) == 0);
  CHECK(allocationsOf([&] { contactForces(model, data, q, v, tau, tau, c, cones); }) == 0);
  CHECK(allocationsOf([&] { projectConfiguration(model, data, q, c); }) == 0);
  c.settings.mu = 1e-3;
  CHECK(allocationsOf([&] { constraintDynamics(model, data, q, v, tau, c); }) == 0);
}

TEST_CASE("a humanoid's Data takes at most 150 kB", "[no_alloc]") {
  DYN_NEEDS_SHARED();
  urdf::Options options;
  options.root = "free_flyer";
  const CompactModel talos = compile(urdf::load(sharedFolder() + "/models/talos.urdf", options), JointRegistry::standard());
  CHECK(Data(talos).bytes() <= 150000);
}

TEST_CASE("memory grows with the model, not with its square", "[no_alloc]") {
  const JointRegistry registry = JointRegistry::standard();
  const auto bytes = [&](int n) { return Data(compile(randomTree(registry, n, 3), registry)).bytes(); };
  CHECK(static_cast<double>(bytes(2000)) < 2.1 * static_cast<double>(bytes(1000)));
}
