// SPDX-License-Identifier: BSD-2-Clause
// Kernels of one table for derivatives of single states.
#include "kernels/body/scratch.hpp"
#include "kernels/derivative/aba_derivatives.hpp"
#include "kernels/derivative/coriolis.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

void addDerivatives(SingleKernels& k) {
  using W = Workspace<double>;
  using D = DerivativeWorkspace<double>;
#if DYN_JOINTS_IN_LANES
  k.laneGroupBytes = [](const CompactImpl& m) { return scratchBytes<LaneGroupDerivatives<Wide>>(m); };
  k.prepareLaneGroups = [](const CompactImpl& m, char* scratch, D& d) {
    auto& s = makeScratch<LaneGroupDerivatives<Wide>>(scratch, m);
    s.w.R[0] = Mat3<Wide>::identity();
    d.lane_groups = scratch;
    d.group_arrays = s.arrays();
  };
#endif
  k.evaluateSubspaces = [](const CompactImpl& m, D& d, const double* q, const double* v) { evaluateSubspaceDerivatives(m, d, q, v); };
  k.rneaDerivatives = [](const CompactImpl& m, W& w, D& d, const double* v, const double* a, const Force<double>* fext, const PathDerivatives& out) {
    rneaDerivativesInPlace<WidestPack, Wide>(m, w, d, v, a, fext, out);
  };
  k.abaDerivatives = [](const CompactImpl& m, W& w, D& d, const double* v, const double* tau, const Force<double>* fext, double* ddq, double* by_q,
                        double* by_v, double* inverse) {
    kernels::abaDerivatives<WidestPack>(m, w, d, v, tau, fext, ddq, {by_q, by_v, inverse});
    return w.failed[0];
  };
  k.coriolis = [](const CompactImpl& m, W& w, D& d, const double* v, const double* zeros) { coriolisMatrix<WidestPack>(m, w, d, v, zeros); };
  k.assemble = [](const CompactImpl& m, const PathMatrix<double>& from, double* out) {
    from.assemble<WidestPack>(m.dof_end, Rows<double>{out, m.nvx});
  };
}

}  // namespace dyn::kernels
