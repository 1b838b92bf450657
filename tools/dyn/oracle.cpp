// SPDX-License-Identifier: BSD-2-Clause
#include "oracle.hpp"

#include "exact_quantities.hpp"
#include "gragg.hpp"

namespace dyn::tool {

namespace {

/// The time derivative of y = (q, v) in free motion: dq/dt in the joints' coordinates, and M^-1 (- nle).
VectorR rate(const ExactBodies& x, const VectorR& y, Eigen::Index nq) {
  const VectorR q = y.topRows(nq), v = y.bottomRows(x.nv), still = VectorR::Zero(x.nv);
  const Place at = x.place(q);
  const BodyJacobians J = x.jacobians(at);
  VectorR out(y.size());
  const std::vector<TimeSeries> moving = x.coordinates(q, v, still);
  for (Eigen::Index k = 0; k < nq; ++k) out[k] = moving[static_cast<std::size_t>(k)].c[1];
  out.bottomRows(x.nv) = x.massMatrix(at, J).inverse() * -x.rnea(at, v, still, J);
  return out;
}

}  // namespace

Oracle::Oracle(const Model& description, const CompactModel& model) : bodies_(std::make_unique<ExactBodies>(description, model)) {}
Oracle::~Oracle() = default;

TruthSample Oracle::evaluate(const State& state, bool derivatives) const {
  TruthSample out{state, {}};
  for (const auto& [key, value] : dynamicsOf(*bodies_, state, derivatives)) out.truth[key] = value.rounded();
  return out;
}

State Oracle::move(const State& start, double time, int steps) const {
  const Eigen::Index nq = start.q.size();
  VectorR y = VectorR::stacked({exact(start.q), exact(start.v)});
  const Real h = Real(time) / Real(steps);
  for (int k = 0; k < steps; ++k) y = extrapolate<8>(y, h, [&](const VectorR& x) { return rate(*bodies_, x, nq); });
  State end = start;
  for (Eigen::Index k = 0; k < nq; ++k) end.q[k] = static_cast<double>(y[k]);
  for (Eigen::Index k = 0; k < bodies_->nv; ++k) end.v[k] = static_cast<double>(y[nq + k]);
  return end;
}

}  // namespace dyn::tool
