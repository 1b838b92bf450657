// SPDX-License-Identifier: BSD-2-Clause
// Steps of many states at once are the steps of simulators.
#include "support/catch.hpp"
#include "support/difference.hpp"
#include "support/registry.hpp"
#include "support/skip.hpp"
#include "support/states.hpp"

#include <dyn/integrate/batch_stepper.hpp>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A model without joint friction, which simulators treat in another way than aba.
CompactModel smooth(std::uint64_t seed, bool coupled) {
  Model description = randomTree(registry(), 12, seed, true);
  if (coupled) addDependent(description);
  CompileOptions options;
  options.dissipation = false;
  return compile(description, registry(), options);
}

constexpr Integrator methods[] = {Integrator::explicit_euler, Integrator::semi_implicit_euler, Integrator::rk4};

}  // namespace

TEST_CASE("rollouts of a batch take the steps of a simulator", "[integrate]") {
  const Integrator method = GENERATE(from_range(std::begin(methods), std::end(methods)));
  CAPTURE(infoOf(method).name);
  const bool coupled = GENERATE(false, true);
  const CompactModel model = smooth(3, coupled);
  constexpr int n = 9, steps = 5;
  constexpr double dt = 1e-3;
  const States s(model, n, 4);
  const Eigen::MatrixXd tau = Eigen::MatrixXd::Random(model.nv(), n * steps);
  Eigen::MatrixXd q(model.nq(), n * steps), v(model.nv(), n * steps);
  BatchStepper stepper(model, n, method, 2);
  stepper.rollout(dt, s.q, s.v, tau, q, v);
  for (int k = 0; k < n; ++k) {
    Simulator simulator(model, {.integrator = method, .dt = dt});
    simulator.reset(s.q.col(k), s.v.col(k));
    for (int step = 0; step < steps; ++step) {
      const Eigen::Index column = step * n + k;
      simulator.setController([&](double, VectorResult, VectorResult, VectorMap force) { force = tau.col(column); });
      simulator.step();
      CHECK(off(q.col(column), simulator.q()) < 1e-10);
      CHECK(off(v.col(column), simulator.v()) < 1e-9);
    }
  }
  // Step by step, in place and with other threads: the same bits.
  Eigen::MatrixXd at_q = s.q, at_v = s.v;
  BatchStepper alone(model, n + 3, method);
  for (int step = 0; step < steps; ++step) alone.step(dt, tau.middleCols(step * n, n), at_q, at_v);
  CHECK(at_q == q.rightCols(n));
  CHECK(at_v == v.rightCols(n));
}

TEST_CASE("steps of a batch refuse other methods and wrong sizes", "[integrate]") {
  const CompactModel model = smooth(5, false);
  CHECK_THROWS_WITH(BatchStepper(model, 3, Integrator::gauss6), containing("gauss6") && containing("rk4"));
  CHECK_THROWS_AS(BatchStepper(model, 0, Integrator::rk4), Error);
  const States s(model, 4, 4);
  BatchStepper stepper(model, 3, Integrator::rk4);
  Eigen::MatrixXd q = s.q, v = s.v, three = s.v.leftCols(3);
  CHECK_THROWS_WITH(stepper.step(1e-3, s.a, q, v), containing("1 to 3"));
  CHECK_THROWS_WITH(stepper.step(1e-3, s.a, q, three), containing("V is"));
  CHECK_THROWS_WITH(stepper.rollout(1e-3, s.q.leftCols(3), s.v.leftCols(3), s.a, q, v), containing("4 columns"));
  CHECK(q == s.q);
}

TEST_CASE("steps of a batch allocate nothing", "[integrate]") {
  if (!tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const CompactModel model = smooth(6, false);
  const States s(model, 11, 4);
  Eigen::MatrixXd q = s.q, v = s.v;
  for (const Integrator method : methods) {
    BatchStepper stepper(model, 11, method, 2);
    const long before = tool::allocationCount();
    stepper.step(1e-3, s.a, q, v);
    CHECK(tool::allocationCount() == before);
  }
}
