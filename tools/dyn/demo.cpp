// SPDX-License-Identifier: BSD-2-Clause
// dyn demo: prints inverse dynamics, mass matrix and forward dynamics at one random state.
#include "commands.hpp"
#include "messages.hpp"
#include "model_options.hpp"
#include "states.hpp"

#include <memory>

namespace dyn::tool {

namespace {

void runDemo(const ModelOptions& o) {
  const CompactModel model = o.compile();
  Data data(model, Need::mass_matrix);
  const State s = randomStates(model, 1, 7)[0];
  const Eigen::VectorXd tau = rnea(model, data, s.q, s.v, s.a);
  const Eigen::MatrixXd M = crba(model, data, s.q);
  const Eigen::VectorXd ddq = aba(model, data, s.q, s.v, tau);
  char columns[128];
  std::snprintf(columns, sizeof columns, "%-24s %12s %12s %12s %14s %12s", "joint", "v", "a", "M diagonal", "tau = rnea(a)", "aba(tau)");
  std::printf("%s\n", heading(columns).c_str());
  for (int j = 1; j < model.njoints(); ++j) {
    const JointRecord& r = model.joints()[static_cast<std::size_t>(j)];
    for (int k = r.idx_v; k < r.idx_v + r.nv; ++k)
      std::printf("%-24s %12.6g %12.6g %12.6g %14.6g %12.6g\n", k == r.idx_v ? r.name.c_str() : "", s.v[k], s.a[k], M(k, k), tau[k], ddq[k]);
  }
  std::printf("\nkinetic energy %.9g J, v'Mv/2 = %.9g J; max |aba(rnea(a)) - a| = %.2g\n", computeKineticEnergy(model, data, s.q, s.v),
              0.5 * s.v.dot(M * s.v), (ddq - s.a).lpNorm<Eigen::Infinity>());
}

}  // namespace

void addDemo(CLI::App& app) {
  CLI::App* sub = addCommand(app, "demo", "inverse dynamics, mass matrix and forward dynamics at a sample state");
  auto o = std::make_shared<ModelOptions>();
  o->add(*sub);
  sub->callback([o] { runDemo(*o); });
}

}  // namespace dyn::tool
