// SPDX-License-Identifier: BSD-2-Clause
// Analytical derivatives agree to rounding with the recursions run on dual numbers, for every joint type.
#include "data/data_impl.hpp"
#include "kernels/body/dissipation.hpp"
#include "kernels/derivative/dual_derivatives.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/rnea.hpp"
#include "support/random_model.hpp"
#include "support/registry.hpp"

using namespace dyn;
using namespace dyn::test;

namespace {

using D = Dual<double>;

/// Runs recursions on dual numbers, from the state of the last computeRNEADerivatives.
struct DualRun {
  const CompactImpl& m;
  DataImpl& d;
  std::vector<double> memory;
  kernels::DualState s;
  std::vector<D> result;

  DualRun(const CompactModel& model, Data& data, const Eigen::VectorXd& v, const Eigen::VectorXd& a)
      : m(model.impl()), d(data.impl()), result(static_cast<std::size_t>(model.nv())) {
    Arena count(nullptr);
    kernels::layOut(s, m, count);
    memory.resize(count.used() / sizeof(double) + 16);
    char* begin = reinterpret_cast<char*>(memory.data());
    Arena arena(begin + (64 - reinterpret_cast<std::uintptr_t>(begin) % 64) % 64);
    kernels::layOut(s, m, arena);
    kernels::loadState(m, d, d.derivatives, v.data(), a.data(), s);
  }
  template <class Run>
  Eigen::MatrixXd alongAll(const Eigen::VectorXd& q, const Eigen::VectorXd& v, Run&& run) {
    Eigen::MatrixXd out(m.nv, m.nv);
    for (int k = 0; k < m.nv; ++k) {
      const int body = m.dof_body[static_cast<std::size_t>(k)], first = m.index[static_cast<std::size_t>(body)].idx_v;
      kernels::moveAlong(m, d, d.derivatives, q.data(), v.data(), body, k - first, s);
      run();
      kernels::standStill(m, d, d.derivatives, body, k - first, s);
      for (int i = 0; i < m.nv; ++i) out(i, k) = result[static_cast<std::size_t>(i)].d;
    }
    return out;
  }
};

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff(); }

}  // namespace

TEST_CASE("derivatives by q are those of the recursions on dual numbers", "[dual]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 25)));
  const CompactModel model = compile(randomTree(registry(), 12, seed), registry());
  Data data(model, Need::derivatives), other(model, Need::derivatives);
  Random random(seed);
  const Eigen::VectorXd q = integrate(model, neutral(model), random.vector(model.nv(), 1)), v = random.vector(model.nv(), 1),
                        a = random.vector(model.nv(), 2), tau = random.vector(model.nv(), 5);
  const Eigen::MatrixXd dtau_dq = computeRNEADerivatives(model, data, q, v, a).dtau_dq;
  DualRun run(model, data, v, a);
  const kernels::Bodies<D> bodies{run.m, run.s.w};
  const Eigen::MatrixXd by_rnea = run.alongAll(q, v, [&] {
    kernels::rneaOutward(bodies, run.s.w, run.s.v, run.s.a);
    kernels::rneaInward(bodies, run.s.w, run.result.data());
  });
  CHECK(distance(dtau_dq, by_rnea) < 1e-12);

  const Eigen::MatrixXd ddq_dq = computeABADerivatives(model, other, q, v, tau).ddq_dq;
  for (int k = 0; k < model.nv(); ++k) run.s.a[k] = D(tau[k], 0.0);
  const Eigen::MatrixXd by_aba = run.alongAll(q, v, [&] {
    kernels::abaOutward(bodies, run.s.w, run.s.v);
    kernels::abaInward(bodies, run.s.w, run.s.a);
    kernels::abaSolve(bodies, run.s.w, bodies.gravity(), run.result.data());
  });
  CHECK(distance(ddq_dq, by_aba) < 1e-12);
}
