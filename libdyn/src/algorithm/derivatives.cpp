#include "algorithm/external.hpp"
#include "algorithm/inputs.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/derivatives.hpp>

namespace dyn::detail {

namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

void checkFactors(const char* algorithm, const CompactImpl& m, int failed_body) {
  if (failed_body != 0) refuseSingular(algorithm, m.joints[at(m.index[at(failed_body)].joint)].name);
}

/// Joints evaluated, forces read.
struct Prepared {
  Inputs in;
  const Force<double>* external;
};
Prepared prepare(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                 const Force<double>* fext, std::size_t count) {
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, v, a);
  const Force<double>* external = readExternalForces(algorithm, m, d, fext, count);
  evaluateJoints(m, d, in.q, in.v);
  return {in, external};
}

}  // namespace

DerivativeViews rneaDerivatives(const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                                const Force<double>* fext, std::size_t count) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Prepared x = prepare("computeRNEADerivatives", model, data, q, v, a, fext, count);
  const kernels::SingleKernels& k = kernels::active().single;
  k.rneaDerivatives(m, d, d.derivatives, x.in.q, x.in.v, x.in.a, x.external);
  k.assemble(m, d.derivatives.by_q, d.dtau_dq);
  k.assemble(m, d.derivatives.by_v, d.dtau_dv);
  k.assemble(m, d.derivatives.by_a, d.M);
  return {nullptr, d.dtau_dq, d.dtau_dv, d.M};
}

DerivativeViews abaDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                               std::size_t count) {
  const char* algorithm = "computeABADerivatives";
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  aba(model, data, q, v, tau, fext, count);
  const VectorView ddq{d.ddq, m.nv};
  const Prepared x = prepare(algorithm, model, data, q, &v, &ddq, fext, count);
  checkFactors(algorithm, m,
               kernels::active().single.abaDerivatives(m, d, d.derivatives, x.in.q, x.in.v, x.in.a, x.external, d.ddq_dq, d.ddq_dv, d.Minv));
  for (std::size_t k = 0; k < m.damping.size(); ++k)
    for (std::size_t i = 0; i < m.damping.size(); ++i) d.ddq_dv[m.damping.size() * k + i] -= d.Minv[m.damping.size() * k + i] * m.damping[k];
  return {d.ddq, d.ddq_dq, d.ddq_dv, d.Minv};
}

const double* minverse(const CompactModel& model, Data& data, VectorView q) {
  const char* algorithm = "computeMinverse";
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const Inputs in = readInputs(algorithm, model, data, q, nullptr, nullptr);
  evaluateJoints(m, d, in.q, nullptr);
  const kernels::SingleKernels& k = kernels::active().single;
  checkFactors(algorithm, m, k.treeFactors(m, d, d.derivatives));
  k.inverseOfMassMatrix(m, d.derivatives, d.Minv);
  return d.Minv;
}

}  // namespace dyn::detail
