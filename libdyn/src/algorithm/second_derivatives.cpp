// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "kernels/derivative/dual_derivatives.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/second_derivatives.hpp>
#include <dyn/error.hpp>

#include <algorithm>

namespace dyn {

struct SecondDerivativeImpl {
  explicit SecondDerivativeImpl(const CompactModel& m) : model(m) {}
  CompactModel model;
  PackMemory block;
  kernels::DualState state;
  double *qq = nullptr, *qv = nullptr, *vv = nullptr, *aq = nullptr;
  double* unit = nullptr;  ///< nv
};

SecondDerivativeData::SecondDerivativeData(const CompactModel& model) : impl_(std::make_unique<SecondDerivativeImpl>(model)) {
  const CompactImpl& m = model.impl();
  const auto n = static_cast<std::size_t>(m.nvx);
  const auto layOutAll = [&](Arena& arena) {
    kernels::layOut(impl_->state, m, arena);
    for (double** tensor : {&impl_->qq, &impl_->qv, &impl_->vv, &impl_->aq}) arena.take(*tensor, n * n * n);
    arena.take(impl_->unit, n);
  };
  Arena count(nullptr);
  layOutAll(count);
  impl_->block = PackMemory(count.used());  // zeroed
  Arena arena(impl_->block.data());
  layOutAll(arena);
}

SecondDerivativeData::~SecondDerivativeData() = default;
SecondDerivativeData::SecondDerivativeData(SecondDerivativeData&&) noexcept = default;
SecondDerivativeData& SecondDerivativeData::operator=(SecondDerivativeData&&) noexcept = default;
std::size_t SecondDerivativeData::bytes() const { return impl_->block.bytes() + sizeof(SecondDerivativeImpl); }

namespace detail {

SecondDerivativeViews rneaSecondDerivatives(const CompactModel& model, Data& data, SecondDerivativeData& second, VectorView q, VectorView v,
                                            VectorView a) {
  const char* algorithm = "computeRNEASecondOrderDerivatives";
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  SecondDerivativeImpl& s = second.impl();
  refuseDependentJoints(algorithm, m);
  if (&s.model.impl() != &m) throw Error(ErrorCode::argument, std::string(algorithm) + ": the memory was made for another model");
  copyAliasedArguments(data, {.q = &q, .v = &v, .a = &a}, &s.block);
  const std::ptrdiff_t n = m.nv, square = n * n;
  // D = dtau/dv is linear in v, plus the constant damping, because tau is quadratic in v. The slope of D along a unit velocity is D there less
  // damping.
  const VectorView unit{s.unit, n}, zero{d.zero, n};
  for (std::ptrdiff_t k = 0; k < n; ++k) {
    s.unit[k] = 1;
    rneaDerivatives(model, data, q, &unit, &zero, nullptr, 0);
    s.unit[k] = 0;
    double* out = s.vv + square * k;
    std::copy_n(d.dtau_dv, square, out);
    for (std::size_t i = 0; i < m.damping.size(); ++i) out[(n + 1) * static_cast<std::ptrdiff_t>(i)] -= m.damping[i];
  }
  const Inputs in = readInputs(algorithm, model, data, q, &v, &a);
  evaluateJoints(m, d, in.q, in.v);
  kernels::active().single.evaluateSubspaces(m, d.derivatives, in.q, in.v);
  kernels::loadState(m, d, d.derivatives, in.v, in.a, s.state);
  for (int k = 0; k < m.nv; ++k) {
    const int body = m.dof_body[static_cast<std::size_t>(k)];
    kernels::derivativesAlong(m, d, d.derivatives, in.q, in.v, body, k - m.index[static_cast<std::size_t>(body)].idx_v, s.state, s.qq + square * k,
                              s.qv + square * k, s.aq + square * k);
  }
  return {s.qq, s.qv, s.vv, s.aq};
}

}  // namespace detail

}  // namespace dyn
