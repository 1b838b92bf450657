// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/external.hpp"
#include "algorithm/support/inputs.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/algorithm/rnea.hpp>

namespace dyn::detail {

namespace {

const double* inverseDynamics(const CompactImpl& m, DataImpl& d, const Inputs& in, const Force<double>* fext, double* result) {
  double* tau = m.couplings.empty() ? result : d.taux;
  if (const kernels::PackedKernels* k = kernels::packed(m, &LaneGroupUses::rnea); k && fext == nullptr) {
    if (!k->rnea(m, d.packed[k->over_lane_groups].data(), in.q, in.v, in.a, tau)) checkConfiguration("q", m, in.user_q);
  } else {
    evaluateJoints(m, d, in.q, in.v);
    kernels::active().single.rnea(m, d, in.v, in.a, fext, tau);
  }
  reduceForces(m, d, tau, result);
  return result;
}

}  // namespace

const double* rnea(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView a, const Force<double>* fext, std::size_t count) {
  const Inputs in = readInputs("rnea", model, data, q, &v, &a);
  DataImpl& d = data.impl();
  return inverseDynamics(model.impl(), d, in, readExternalForces("rnea", model.impl(), d, fext, count), d.tau);
}

const double* nonLinearEffects(const CompactModel& model, Data& data, VectorView q, VectorView v) {
  const Inputs in = readInputs("nonLinearEffects", model, data, q, &v, nullptr);
  return inverseDynamics(model.impl(), data.impl(), in, nullptr, data.impl().nle);
}

const double* generalizedGravity(const CompactModel& model, Data& data, VectorView q) {
  const Inputs in = readInputs("generalizedGravity", model, data, q, nullptr, nullptr);
  return inverseDynamics(model.impl(), data.impl(), in, nullptr, data.impl().g);
}

const double* staticTorque(const CompactModel& model, Data& data, VectorView q, const Force<double>* fext, std::size_t count) {
  const char* name = info(Algorithm::static_torque).function;
  const Inputs in = readInputs(name, model, data, q, nullptr, nullptr);
  DataImpl& d = data.impl();
  return inverseDynamics(model.impl(), d, in, readExternalForces(name, model.impl(), d, fext, count), d.tau);
}

}  // namespace dyn::detail
