// SPDX-License-Identifier: BSD-2-Clause
// Regressors: the dynamics are linear in the bodies' inertial parameters.
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

TEST_CASE("torques and energies are regressors times parameters, for all joint types and followers", "[regressor]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 7)));
  Model description = randomTree(registry(), seed == 4 ? 22 : 15, seed);
  if (seed == 4) addDependent(description);
  const CompactModel model = compile(description, registry());
  Data data(model, Need::derivatives), other(model);
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2);
  const Eigen::VectorXd pi = dynamicParameters(model);
  CHECK(off(computeJointTorqueRegressor(model, data, q, v, a) * pi, rnea(model, other, q, v, a)) < 1e-13);
  CHECK(std::fabs(computeKineticEnergyRegressor(model, data, q, v).dot(pi) / computeKineticEnergy(model, other, q, v) - 1) < 1e-12);
  CHECK(std::fabs(computePotentialEnergyRegressor(model, data, q).dot(pi) - computePotentialEnergy(model, other, q)) <
        1e-12 * (1 + std::fabs(computePotentialEnergy(model, other, q))));
}

TEST_CASE("torque regressors have entries on root paths only, for models of every size", "[regressor]") {
  const int bodies = GENERATE(range(1, 13));
  const CompactModel model = compile(randomTree(registry(), bodies, static_cast<std::uint64_t>(bodies)), registry());
  Data data(model, Need::derivatives), other(model);
  Random random(7);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 0.8)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2);
  const auto& joints = model.joints();
  const auto supports = [&](int i, int j) {
    while (j > i) j = joints[static_cast<std::size_t>(j)].parent;
    return i == j;
  };
  const auto check = [&] {
    const Eigen::MatrixXd Y = computeJointTorqueRegressor(model, data, q, v, a);
    CHECK(off(Y * dynamicParameters(model), rnea(model, other, q, v, a)) < 1e-13);
    for (int i = 1; i < model.njoints(); ++i)
      for (int j = 1; j < model.njoints(); ++j) {
        const JointRecord& joint = joints[static_cast<std::size_t>(i)];
        if (!supports(i, j)) CHECK((Y.block(joint.idx_v, 10 * (j - 1), joint.nv, 10).array() == 0).all());
      }
  };
  check();
  // Neither NaN nor the results of other functions leave anything behind.
  const Eigen::VectorXd bad = Eigen::VectorXd::Constant(model.nv(), std::numeric_limits<double>::quiet_NaN());
  CHECK(!computeJointTorqueRegressor(model, data, q, bad, bad).allFinite());
  CHECK(!computeKineticEnergyRegressor(model, data, q, bad).allFinite());
  check();
}

TEST_CASE("a body's regressor is Newton's and Euler's equations", "[regressor]") {
  Random random(3);
  const Inertia<double> Y = random.inertia();
  const Motion<double> v{random.vector(), random.vector()}, a{random.vector(), random.vector()};
  const DynamicParameters pi = toDynamicParameters(Y);
  const Force<double> p = Y * v, f = Y * a;
  const Force<double> expected{f.linear + cross(v.angular, p.linear), f.angular + cross(v.angular, p.angular) + cross(v.linear, p.linear)};
  CHECK(off(bodyRegressor(v, a) * Eigen::Map<const Eigen::VectorXd>(pi.data(), 10), toEigen(expected)) < 1e-14);
}

TEST_CASE("inertial parameters go round: ten-vector, pseudo-inertia, log-Cholesky", "[regressor]") {
  for (std::uint64_t seed = 1; seed < 20; ++seed) {
    const Inertia<double> Y = Random(seed).inertia();
    const DynamicParameters pi = toDynamicParameters(Y);
    const auto same = [&](const DynamicParameters& x) {
      for (std::size_t k = 0; k < 10; ++k) CHECK(std::fabs(x[k] - pi[k]) < 1e-14 * (1 + std::fabs(pi[k])));
    };
    same(toDynamicParameters(inertiaFromDynamicParameters(pi)));
    same(dynamicParameters(pseudoInertia(pi)));
    same(dynamicParameters(pseudoInertiaFromLogCholesky(logCholesky(pseudoInertia(pi)))));
    CHECK(physicalConsistency(Y).consistent);
    CHECK(physicalConsistency(Y).margin > 0);
  }
  // Any ten log-Cholesky parameters describe a physically consistent body.
  const LogCholeskyParameters theta{0.3, -1, 0.5, 2, 3, -2, 1, 0.4, -7, 1};
  CHECK(physicalConsistency(inertiaFromDynamicParameters(dynamicParameters(pseudoInertiaFromLogCholesky(theta)))).consistent);
}

TEST_CASE("bodies that cannot be are told from those that can", "[regressor]") {
  CHECK(physicalConsistency({1, {}, {1, 0, 0, 1, 0, 2}}).consistent);  // a disc
  CHECK(physicalConsistency({1, {}, {1, 0, 0, 1, 0, 2}}).margin == Approx(0).margin(1e-15));
  CHECK(physicalConsistency({1, {0, 0, 5}, {}}).consistent);  // a point
  CHECK_FALSE(physicalConsistency({1, {}, {1, 0, 0, 1, 0, 2.1}}).consistent);
  CHECK_FALSE(physicalConsistency({0, {}, {1, 0, 0, 1, 0, 1}}).consistent);
  CHECK_FALSE(physicalConsistency({-1, {}, {1, 0, 0, 1, 0, 1}}).consistent);
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::numeric_limits<double>::quiet_NaN();
  CHECK_FALSE(physicalConsistency({infinity, {}, {1, 0, 0, 1, 0, 1}}).consistent);
  CHECK_FALSE(physicalConsistency({1, {nan, 0, 0}, {1, 0, 0, 1, 0, 1}}).consistent);
  CHECK_FALSE(physicalConsistency({1, {0, 0, infinity}, {}}).consistent);
  CHECK_FALSE(physicalConsistency({1, {}, {1, 5, 0, 1, 0, 1}}).consistent);
  CHECK_FALSE(physicalConsistency({1, {}, {std::nan(""), 0, 0, 1, 0, 1}}).consistent);
  CHECK_THROWS_WITH(inertiaFromDynamicParameters({0, 1, 0, 0, 0, 0, 0, 0, 0, 0}), containing("first moment"));
  CHECK_THROWS_WITH(logCholesky(pseudoInertia(toDynamicParameters({1, {}, {1, 0, 0, 1, 0, 2.1}}))), containing("positive definite"));
}
