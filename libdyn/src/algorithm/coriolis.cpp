#include "algorithm/followers.hpp"
#include "algorithm/inputs.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/coriolis.hpp>

namespace dyn::detail {

namespace {

/// G^T (C G + M dG/dt).
void fold(const CompactImpl& m, const DataImpl& d, double* C, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const std::ptrdiff_t s = m.index[static_cast<std::size_t>(m.couplings[k].body)].idx_v;
    const std::ptrdiff_t t = m.index[static_cast<std::size_t>(m.couplings[k].master)].idx_v;
    for (std::ptrdiff_t i = 0; i < n; ++i) {
      C[t * n + i] += d.G[k] * C[s * n + i] + d.dG[k] * d.vx[t] * M[s * n + i];
      M[t * n + i] += d.G[k] * M[s * n + i];
    }
    for (double* x : {C, M})
      for (std::ptrdiff_t j = 0; j < n; ++j) x[j * n + t] += d.G[k] * x[j * n + s];
  }
}

}  // namespace

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
  fold(m, d, C, M);
  keepUsersEntries(m, C, d.C);
  for (double* x : {C, M}) std::fill(x, x + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);  // folding has written where there are no paths
  return d.C;
}

}  // namespace dyn::detail
