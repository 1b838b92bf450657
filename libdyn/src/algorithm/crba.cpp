#include "algorithm/crba.hpp"

#include "algorithm/followers.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/crba.hpp>

#include <algorithm>

namespace dyn {

const double* massMatrix(const CompactImpl& m, DataImpl& d) {
  if (m.couplings.empty()) {
    kernels::active().single.massMatrix(m, d, d.M);
    return d.M;
  }
  // Folding rows fills entries that the kernel leaves as they are.
  std::fill(d.Mx, d.Mx + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);
  kernels::active().single.massMatrix(m, d, d.Mx);
  const kernels::Followers<double> followers = followersOf(m, d);
  followers.foldInertia(d.Mx);
  followers.keepSquare(d.Mx, d.M);
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
