// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/crba.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <dyn/algorithm/crba.hpp>

#include <algorithm>

namespace dyn {

const double* massMatrix(const CompactImpl& m, DataImpl& d, const Inputs& in) {
  const bool coupled = !m.couplings.empty();
  double* M = coupled ? d.Mx : d.M;
  // Folding also writes entries off the root paths, which kernels leave as they are.
  if (coupled) std::fill(M, M + static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);
  if (const kernels::PackedKernels* k = kernels::packed(m, &LaneGroupUses::mass_matrix)) {
    if (!k->massMatrix(m, d.packed[k->over_lane_groups].data(), in.q, M)) checkConfiguration("q", m, in.user_q);
  } else {
    evaluateJoints(m, d, in.q, nullptr);
    kernels::active().single.massMatrix(m, d, M);
  }
  if (coupled) {
    const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
    dependents.foldInertia(M);
    dependents.keepSquare(M, d.M);
  }
  return d.M;
}

void factorInertia(const char* algorithm, const CompactImpl& m, const DataImpl& d, double* M, double* diagonal) {
  int failed = 0;
  kernels::factorDense(m, M, diagonal, &failed);
  checkFactors(algorithm, m, failed, d.qx);
}

namespace detail {
const double* crba(const CompactModel& model, Data& data, VectorView q) {
  checkData("crba", model, data, Need::mass_matrix);
  return massMatrix(model.impl(), data.impl(), readInputs("crba", model, data, q, nullptr, nullptr));
}
}  // namespace detail

}  // namespace dyn
