#include "algorithm/crba.hpp"

#include "kernels/table.hpp"

#include <dyn/algorithm/crba.hpp>

#include <algorithm>

namespace dyn {

namespace {
std::size_t at(int i) { return static_cast<std::size_t>(i); }

/// G^T Mx G, coupling by coupling: the follower's row and column are added to its master's.
void reduceMassMatrix(const CompactImpl& m, const DataImpl& d, double* Mx, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (std::size_t k = m.couplings.size(); k-- > 0;) {
    const std::ptrdiff_t s = m.index[at(m.couplings[k].body)].idx_v, t = m.index[at(m.couplings[k].master)].idx_v;
    for (std::ptrdiff_t i = 0; i < n; ++i) Mx[t * n + i] += d.G[k] * Mx[s * n + i];
    for (std::ptrdiff_t i = 0; i < n; ++i) Mx[i * n + t] += d.G[k] * Mx[i * n + s];
  }
  for (std::size_t i = 0; i < m.v_of_user.size(); ++i)
    for (std::size_t j = 0; j < m.v_of_user.size(); ++j) M[i * m.v_of_user.size() + j] = Mx[m.v_of_user[i] * n + m.v_of_user[j]];
}

}  // namespace

const double* massMatrix(const CompactImpl& m, DataImpl& d) {
  if (m.couplings.empty()) {
    kernels::active().single.massMatrix(m, d, d.M);
    return d.M;
  }
  // Folding rows fills entries that the kernel leaves as they are.
  std::fill(d.Mx, d.Mx + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);
  kernels::active().single.massMatrix(m, d, d.Mx);
  reduceMassMatrix(m, d, d.Mx, d.M);
  return d.M;
}

namespace detail {
const double* crba(const CompactModel& model, Data& data, VectorView q) {
  checkData("crba", model, data, Need::mass_matrix);
  const Inputs in = readInputs("crba", model, data, q, nullptr, nullptr);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (const kernels::PackedKernels* k = kernels::packedMassMatrix(m)) {
    char* scratch = k == kernels::packed(m) ? d.packed.data() : d.packed_mass_matrix.data();
    if (!k->massMatrix(m, scratch, in.q, d.M)) checkConfiguration("q", m, in.q);
    return d.M;
  }
  evaluateJoints(m, d, in.q, nullptr);
  return massMatrix(m, d);
}
}  // namespace detail

}  // namespace dyn
