// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/crba.hpp"
#include "algorithm/support/external.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <dyn/algorithm/aba.hpp>

namespace dyn::detail {

const double* aba(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext, std::size_t count) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau});
  if (!m.couplings.empty()) {
    checkData("aba of a model with dependent joints", model, data, Need::mass_matrix);
    checkSize("aba", "tau", tau, m.nv);
    const VectorView zero{d.zero, m.nv};
    const double* bias = rnea(model, data, q, v, zero, fext, count);
    for (int k = 0; k < m.nv; ++k) d.ddq[k] = tau.data[k] - bias[k];
    massMatrix(m, d, {.q = d.qx, .user_q = q.data});
    factorInertia("aba", m, d, d.M, d.ax);
    kernels::solveDense(m, d.M, d.ddq);
    return d.ddq;
  }
  const Inputs in = readInputs("aba", model, data, q, &v, nullptr);
  checkSize("aba", "tau", tau, m.nv);
  const Force<double>* external = readExternalForces("aba", m, d, fext, count);
  const double* effective = lessDissipation(m, d, tau.data, in.v);
  int body = 0;
  if (const kernels::PackedKernels* k = kernels::packed(m, &LaneGroupUses::aba); k && external == nullptr) {
    char* const scratch = d.packed[k->over_lane_groups].data();
    if (!k->articulate(m, scratch, in.q, in.v, effective, body)) checkConfiguration("q", m, in.q);
    k->accelerate(m, scratch, m.gravity, d.ddq);
  } else {
    evaluateJoints(m, d, in.q, in.v);
    const kernels::SingleKernels& single = kernels::active().single;
    single.articulate(m, d, in.v, effective, external);
    single.accelerate(m, d, m.gravity, d.ddq);
    body = d.failed[0];
  }
  checkFactors("aba", m, body, in.q);
  return d.ddq;
}

}  // namespace dyn::detail
