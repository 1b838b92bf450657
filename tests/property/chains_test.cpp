// SPDX-License-Identifier: BSD-2-Clause
// Long chains: bounds on the growth of errors and memory with their length.
#include "errors.hpp"
#include "oracle.hpp"
#include "problems.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"

#include <dyn/dyn.hpp>

#include <cmath>

using namespace dyn;
using namespace dyn::test;
using dyn::tool::ErrorSummary;
using dyn::tool::TruthSample;

TEST_CASE("scaled errors of chains do not grow with their length, relative ones at most like its square", "[chain]") {
  for (const int n : {5, 10, 20, 40, 80}) {
    const Model description = tool::chain(n);
    const CompactModel model = compile(description, registry());
    Data data(model, Need::derivatives);
    const tool::Oracle oracle(description, model);
    ErrorSummary inverse, forward, by_factors;
    double relative = 0;
    for (const tool::State& s : tool::randomStates(model, n <= 20 ? 4 : 1, 5)) {
      const TruthSample truth = oracle.evaluate(s, false);
      tool::addErrors(truth, "rnea", rnea(model, data, s.q, s.v, s.a), 0x1p-53, inverse);
      const Eigen::VectorXd ddq = aba(model, data, s.q, s.v, s.tau);
      tool::addErrors(truth, "aba", ddq, 0x1p-53, forward);
      tool::addErrors(truth, "forward_dynamics_cholesky", forwardDynamics(model, data, s.q, s.v, s.tau), 0x1p-53, by_factors);
      relative = std::max(relative, tool::relativeError({ddq.begin(), ddq.end()}, truth.truth.at("aba")));
    }
    INFO(n << " links: rnea " << inverse.most() << " u, aba " << forward.most() << " u, Cholesky " << by_factors.most() << " u, aba relative "
           << relative << " u");
    // These are the budgets of every model, whatever its length.
    CHECK(inverse.most() < 10);
    CHECK(forward.most() < 4);
    CHECK(by_factors.most() < 4);
    CHECK(relative < n * n);
  }
}

TEST_CASE("forward and inverse dynamics of ten thousand links undo each other", "[chain]") {
  for (const int n : {100, 1000, 10000}) {
    const CompactModel model = compile(tool::chain(n), registry());
    Data data(model);
    const tool::State s = tool::randomStates(model, 1, 3)[0];
    const Eigen::VectorXd ddq = aba(model, data, s.q, s.v, s.tau), tau = rnea(model, data, s.q, s.v, ddq);
    // The size of the terms of tau: weights and accelerations of n links times their moment arms, which grow as a random walk of n links does.
    const double lever = 0.3 * std::sqrt(n), scale = n * 1.5 * lever * (9.81 + ddq.cwiseAbs().maxCoeff() * lever);
    INFO(n << " links: residual " << (tau - s.tau).cwiseAbs().maxCoeff() << ", scale " << scale);
    CHECK((tau - s.tau).cwiseAbs().maxCoeff() < 100 * 0x1p-53 * scale);
    CHECK(data.bytes() < 4000 * static_cast<std::size_t>(n) + 100000);
  }
}
