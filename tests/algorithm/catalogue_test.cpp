// SPDX-License-Identifier: BSD-2-Clause
// The catalogue of algorithms: it is complete, and its entries give what the algorithms' own functions give.
#include "support/catch.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

#include <dyn/codegen/trace.hpp>

#include <algorithm>
#include <set>
#include <string>

using namespace dyn;
using namespace dyn::test;

namespace {

bool readsStateAlone(const AlgorithmInfo& algorithm) { return !algorithm.reads('f'); }

}  // namespace

TEST_CASE("names in the catalogue are unique, and traces are those that trace() knows", "[catalogue]") {
  std::set<std::string> names, keys;
  const std::vector<std::string>& traceable = traceableFunctions();
  for (const AlgorithmInfo& algorithm : algorithms()) {
    INFO(algorithm.function);
    if (algorithm.name != nullptr) CHECK(names.insert(algorithm.name).second);
    if (algorithm.traced != nullptr) CHECK(std::count(traceable.begin(), traceable.end(), algorithm.traced) == 1);
    for (const AlgorithmOutput& output : algorithm.outputs)
      if (output.key != nullptr) CHECK(keys.insert(output.key).second);
  }
}

TEST_CASE("a batch gives what single calls give, for every entry of the catalogue", "[catalogue]") {
  const CompactModel model = compile(randomTree(registry(), 12, 5), registry());
  constexpr int states = 9;
  Eigen::MatrixXd Q(model.nq(), states), V(model.nv(), states), A(model.nv(), states);
  for (int k = 0; k < states; ++k) Q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(k));
  V.setRandom();
  A.setRandom();
  Data data(model, Need::derivatives);
  BatchData batch(model, states, Need::derivatives | Need::kinematics | Need::jacobians);
  for (const AlgorithmInfo& algorithm : algorithms()) {
    if (!algorithm.batched || !readsStateAlone(algorithm)) continue;
    INFO(algorithm.function);
    const auto results = runAlgorithm(model, batch, algorithm.algorithm, Q, V, A);
    if (algorithm.batch_need == Need::kinematics) continue;  // its results are read by framePlacement and the like
    for (int state = 0; state < states; ++state) {
      const AlgorithmResults single = runAlgorithm(model, data, algorithm.algorithm, Q.col(state), V.col(state), A.col(state));
      for (std::size_t k = 0; k < algorithm.outputs.size() && algorithm.outputs[k].symbol != nullptr; ++k) {
        INFO(algorithm.outputs[k].symbol);
        const Eigen::MatrixXd expected = single(k);
        const Eigen::VectorXd column = results(k).col(state);
        REQUIRE(column.size() == expected.size());
        CHECK((column - expected.reshaped()).norm() <= 1e-11 * (1 + expected.norm()));
      }
    }
  }
}

TEST_CASE("entries that read more than a state refuse to run on one", "[catalogue]") {
  const CompactModel model = compile(randomTree(registry(), 4, 1), registry());
  Data data(model);
  const Eigen::VectorXd q = neutral(model), zero = Eigen::VectorXd::Zero(model.nv());
  for (const Algorithm algorithm : {Algorithm::frame_jacobian, Algorithm::static_torque})
    CHECK_THROWS_AS(runAlgorithm(model, data, algorithm, q, zero, zero), Error);
  for (const Algorithm algorithm : {Algorithm::aba, Algorithm::static_torque}) CHECK_THROWS_AS(compute(model, data, algorithm, q, zero, zero), Error);
}

TEST_CASE("the static torque holds the robot against gravity and external forces", "[catalogue]") {
  const CompactModel model = compile(randomTree(registry(), 8, 3), registry());
  Data data(model);
  const Eigen::VectorXd q = randomConfiguration(model, 7);
  ExternalForces fext(static_cast<std::size_t>(model.njoints()));
  // Gravity by differences of the potential energy, which shares no code with the recursion.
  Eigen::VectorXd expected(model.nv()), step = Eigen::VectorXd::Zero(model.nv());
  constexpr double h = 1e-5;
  for (Eigen::Index k = 0; k < model.nv(); ++k) {
    step[k] = h;
    const double above = computePotentialEnergy(model, data, integrate(model, q, step));
    const double below = computePotentialEnergy(model, data, integrate(model, q, -step));
    step[k] = 0;
    expected[k] = (above - below) / (2 * h);
  }
  Eigen::MatrixXd J(6, model.nv());
  for (int joint = 1; joint < model.njoints(); ++joint) {
    const Eigen::Matrix<double, 6, 1> f = Eigen::Matrix<double, 6, 1>::Random();
    fext[static_cast<std::size_t>(joint)] = {{f[0], f[1], f[2]}, {f[3], f[4], f[5]}};
    computeJointJacobian(model, data, q, joint, ReferenceFrame::LOCAL, J);
    expected -= J.transpose() * f;
  }
  const Eigen::VectorXd tau = computeStaticTorque(model, data, q, fext);
  CHECK((tau - expected).norm() < 1e-7 * (1 + expected.norm()));
  CHECK_THROWS_AS(computeStaticTorque(model, data, q, ExternalForces(1)), Error);
}
