// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/inputs.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/coriolis.hpp>

namespace dyn::detail {

const double* coriolisMatrix(const CompactModel& model, Data& data, VectorView q, VectorView v) {
  checkData("computeCoriolisMatrix", model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs("computeCoriolisMatrix", model, data, q, &v, nullptr);
  evaluateJoints(m, d, in.q, in.v);
  const kernels::SingleKernels& k = kernels::active().single;
  k.evaluateSubspaces(m, d.derivatives, in.q, in.v);
  if (m.couplings.empty()) {
    k.coriolis(m, d, d.derivatives, in.v, d.zero);
    k.assemble(m, d.derivatives.by_v, d.C);
    return d.C;
  }
  double *C = d.expanded[0], *M = d.expanded[2];
  k.massMatrix(m, d, M);
  k.coriolis(m, d, d.derivatives, in.v, d.zero);
  k.assemble(m, d.derivatives.by_v, C);
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.foldCoriolis(C, M);
  dependents.keepSquare(C, d.C);
  for (double* x : {C, M}) std::fill(x, x + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);  // folding also writes off the root paths
  return d.C;
}

}  // namespace dyn::detail
