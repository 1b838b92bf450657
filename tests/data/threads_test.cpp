// SPDX-License-Identifier: BSD-2-Clause
// Threads that share one immutable model, with a Data each, get the same bits as one thread. The test, the library and the plugin are built with
// ThreadSanitizer.
#include "support/catch.hpp"
#include "support/random_model.hpp"

#include <cstring>
#include <thread>
#include <vector>

using namespace dyn;
using namespace dyn::test;

namespace {

/// Results of all algorithms at one state.
std::vector<double> everything(const CompactModel& model, std::uint64_t seed) {
  Data data(model, Need::mass_matrix);
  const Eigen::VectorXd q = integrate(model, neutral(model), Eigen::VectorXd::Constant(model.nv(), 0.1 * static_cast<double>(seed)));
  const Eigen::VectorXd v = Eigen::VectorXd::LinSpaced(model.nv(), -1, 1), a = 0.5 * v, tau = 3 * v;
  std::vector<double> all(q.data(), q.data() + q.size());
  const auto take = [&](const auto& x) { all.insert(all.end(), x.data(), x.data() + x.size()); };
  take(rnea(model, data, q, v, a));
  take(nonLinearEffects(model, data, q, v));
  take(generalizedGravity(model, data, q));
  take(crba(model, data, q));
  take(aba(model, data, q, v, tau));
  take(jacobianCenterOfMass(model, data, q));
  take(difference(model, q, neutral(model)));
  take(randomConfiguration(model, seed));
  Eigen::MatrixXd J(6, model.nv());
  const int tool = model.frameId("tool");
  computeFrameJacobian(model, data, q, tool, ReferenceFrame::WORLD, J);
  take(J);
  computeFrameJacobianTimeVariation(model, data, q, v, tool, ReferenceFrame::LOCAL, J);
  take(J);
  all.push_back(computeKineticEnergy(model, data, q, v));
  all.push_back(computePotentialEnergy(model, data, q));
  return all;
}

}  // namespace

TEST_CASE("threads that share a model compute what one thread computes", "[threads]") {
  const JointRegistry registry = JointRegistry::standard();
  const CompactModel model = compile(randomTree(registry, 30, 11, true), registry);
  constexpr std::size_t threads = 4, rounds = 20;
  std::vector<std::vector<double>> alone(rounds);
  for (std::size_t i = 0; i < rounds; ++i) alone[i] = everything(model, i + 1);
  std::vector<int> different(threads, 0);
  std::vector<std::thread> pool;
  pool.reserve(threads);
  for (std::size_t t = 0; t < threads; ++t)
    pool.emplace_back([&, t] {
      const CompactModel copy = model;  // NOLINT: copies share their data, and this is tested here
      for (std::size_t i = 0; i < rounds; ++i) {
        const std::vector<double> mine = everything(copy, i + 1);
        different[t] += mine.size() != alone[i].size() || std::memcmp(mine.data(), alone[i].data(), mine.size() * sizeof(double)) != 0;
      }
    });
  for (std::thread& thread : pool) thread.join();
  for (std::size_t t = 0; t < threads; ++t) CHECK(different[t] == 0);
}

TEST_CASE("threads read one registry and compile at the same time", "[threads]") {
  const JointRegistry registry = JointRegistry::standard();
  const Model description = randomTree(registry, 12, 4);
  std::vector<std::thread> pool;
  pool.reserve(4);
  std::vector<int> nv(4, 0);
  for (std::size_t t = 0; t < 4; ++t) pool.emplace_back([&, t] { nv[t] = compile(description, registry).nv(); });
  for (std::thread& thread : pool) thread.join();
  for (const int n : nv) CHECK(n == nv[0]);
}

TEST_CASE("a batch's own threads meet at the end of each call", "[threads]") {
  const CompactModel model = compile(randomTree(JointRegistry::standard(), 12, 4), JointRegistry::standard());
  constexpr int states = 23;
  BatchData one(model, states), many(model, states, Need::state, 4);
  Eigen::MatrixXd q(model.nq(), states);
  for (int k = 0; k < states; ++k) q.col(k) = randomConfiguration(model, static_cast<std::uint64_t>(k));
  const Eigen::MatrixXd v = Eigen::MatrixXd::Constant(model.nv(), states, 0.3), expected = rnea(model, one, q, v, v);
  for (int round = 0; round < 50; ++round) CHECK(rnea(model, many, q, v, v) == expected);
}

TEST_CASE("threads of a pool have a Data each", "[threads]") {
  const CompactModel model = compile(randomTree(JointRegistry::standard(), 12, 4), JointRegistry::standard());
  DataPool pool(model, Need::state, 4);
  const Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Constant(model.nv(), 0.3);
  Data data(model);
  const Eigen::VectorXd expected = rnea(model, data, q, v, v);
  Eigen::MatrixXd tau(model.nv(), 100);
  for (int round = 0; round < 20; ++round) {
    pool.forEach(tau.cols(), [&](Data& mine, Eigen::Index k) { tau.col(k) = rnea(model, mine, q, v, v); });
    for (Eigen::Index k = 0; k < tau.cols(); ++k) CHECK(tau.col(k) == expected);
  }
}
