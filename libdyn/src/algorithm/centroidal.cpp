// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/centroidal.hpp"

#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/inputs.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/error.hpp>

namespace dyn::detail {

namespace {

void flatten(const Force<double>& f, double* out) {
  for (int r = 0; r < 3; ++r) {
    out[r] = f.linear[r];
    out[3 + r] = f.angular[r];
  }
}

kernels::CentroidalMaps<double> mapsOf(const DataImpl& d, Algorithm algorithm) {
  kernels::CentroidalMaps<double> maps;
  maps.Ag = d.Ag;
  if (algorithm == Algorithm::centroidal_rate) maps.dAg = d.dAg;
  if (algorithm == Algorithm::centroidal_derivatives) {
    maps.dh_dq = d.dh_dq;
    maps.dhdot_dq = d.dhdot_dq;
    maps.dhdot_dv = d.dhdot_dv;
  }
  return maps;
}

CentroidalViews views(const CompactImpl& m, DataImpl& d, Algorithm algorithm, const kernels::CentroidalState<double>& state) {
  flatten(state.momentum, d.hg);
  flatten(state.rate, d.dhg);
  d.locked_inertia = state.inertia.matrix();
  if (!m.couplings.empty()) dependentsOf(m, d).foldMaps(mapsOf(d, algorithm));
  return {d.hg, d.dhg, d.Ag, d.dAg, d.dh_dq, d.dhdot_dq, d.dhdot_dv, &d.locked_inertia};
}

}  // namespace

CentroidalViews centroidal(const CompactModel& model, Data& data, Algorithm algorithm, VectorView q, VectorView v, const VectorView* a) {
  const char* name = info(algorithm).function;
  checkData(name, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (!(m.mass > 0)) throw Error(ErrorCode::singular, std::string(name) + ": the model has no mass, so no centre of mass; give its bodies inertias");
  const Inputs in = readInputs(name, model, data, q, &v, a);
  if (const kernels::PackedKernels* k = kernels::packed(m, &LaneGroupUses::centroidal_map); k && algorithm == Algorithm::centroidal_map) {
    kernels::CentroidalState<double> state;
    if (!k->centroidalMap(m, d.packed[k->over_lane_groups].data(), in.q, in.v, d.Ag, state)) checkConfiguration("q", m, in.user_q);
    return views(m, d, algorithm, state);
  }
  evaluateJoints(m, d, in.q, in.v);
  if (algorithm != Algorithm::centroidal_map) kernels::active().single.evaluateSubspaces(m, d.derivatives, in.q, in.v);
  return centroidalOfEvaluated(m, d, algorithm, in.v, in.a);
}

CenterOfMassViews centerOfMassDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a) {
  centroidal(model, data, Algorithm::centroidal_derivatives, q, v, &a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  double* const out[3] = {d.columns, d.columns + static_cast<std::ptrdiff_t>(3) * m.nvx, d.columns + static_cast<std::ptrdiff_t>(6) * m.nvx};
  const double* const from[3] = {d.dh_dq, d.dhdot_dq, d.dhdot_dv};
  for (int map = 0; map < 3; ++map)
    for (int k = 0; k < m.nv; ++k)
      for (int r = 0; r < 3; ++r) out[map][3 * k + r] = from[map][6 * k + r] / m.mass;
  return {out[0], out[1], out[2]};
}

CentroidalViews centroidalOfEvaluated(const CompactImpl& m, DataImpl& d, Algorithm algorithm, const double* v, const double* a) {
  return views(m, d, algorithm, kernels::active().single.centroidal(m, d, d.derivatives, v, a, mapsOf(d, algorithm)));
}

}  // namespace dyn::detail
