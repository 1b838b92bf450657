// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/derivatives.hpp"

#include "algorithm/crba.hpp"
#include "algorithm/support/dependent_joints.hpp"
#include "algorithm/support/external.hpp"
#include "algorithm/support/inputs.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/algorithm/derivatives.hpp>

#include <algorithm>

namespace dyn {

namespace {

/// The inputs of a call whose joints have been evaluated and whose external forces have been read.
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
  kernels::active().single.evaluateSubspaces(m, d.derivatives, in.q, in.v);
  return {in, external};
}

/// forceDerivatives() of a model with couplings, with M.
void coupledDerivatives(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView& v, const VectorView& a,
                        const Force<double>* fext, std::size_t count) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  detail::rnea(model, data, q, v, a, fext, count);  // leaves the dependent joints' forces in d.taux
  const Prepared x = prepare(algorithm, model, data, q, &v, &a, fext, count);
  const kernels::SingleKernels& k = kernels::active().single;
  double* const user[3] = {d.dtau_dq, d.dtau_dv, d.M};
  k.rneaDerivatives(m, d, d.derivatives, x.in.v, x.in.a, x.external, {d.expanded[0], d.expanded[1], d.expanded[2]});
  const kernels::DependentJoints<double> dependents = dependentsOf(m, d);
  dependents.foldForceDerivatives(d.taux, d.expanded[0], d.expanded[1], d.expanded[2]);
  for (int i = 0; i < 3; ++i) {
    dependents.keepSquare(d.expanded[i], user[i]);
    std::fill_n(d.expanded[i], static_cast<std::ptrdiff_t>(m.nvx) * m.nvx, 0.0);  // folding also writes off the root paths
  }
}

/// Memory of zeros that is used as scratch. The destructor sets it to zero again, also after an exception.
struct BorrowedZeros {
  double* first;
  std::ptrdiff_t count;
  ~BorrowedZeros() { std::fill_n(first, count, 0.0); }
};

void invertDense(const char* algorithm, const CompactImpl& m, DataImpl& d) {
  const std::ptrdiff_t n = m.nv;
  double* factors = d.expanded[0];
  const BorrowedZeros borrowed{factors, static_cast<std::ptrdiff_t>(m.nvx) * m.nvx};
  std::copy(d.M, d.M + n * n, factors);
  factorInertia(algorithm, m, d, factors, d.column);
  kernels::invertDense(m, factors, d.Minv);
}

}  // namespace

void forceDerivatives(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                      const Force<double>* fext, std::size_t count, bool with_M) {
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  VectorView velocity = v ? *v : VectorView{d.zero, m.nv}, acceleration = a ? *a : VectorView{d.zero, m.nv};
  copyAliasedArguments(data, {.q = &q, .v = &velocity, .a = &acceleration});
  if (!m.couplings.empty()) return coupledDerivatives(algorithm, model, data, q, velocity, acceleration, fext, count);
  const Prepared x = prepare(algorithm, model, data, q, &velocity, &acceleration, fext, count);
  kernels::active().single.rneaDerivatives(m, d, d.derivatives, x.in.v, x.in.a, x.external, {d.dtau_dq, d.dtau_dv, with_M ? d.M : nullptr});
}

void invertTreeInertia(const char* algorithm, const CompactImpl& m, DataImpl& d, const double* q) {
  const kernels::SingleKernels& k = kernels::active().single;
  const int failed = k.treeFactors(m, d, d.derivatives);
  k.inverseOfMassMatrix(m, d.derivatives, d.Minv);
  checkFactors(algorithm, m, failed, q);
}

void inverseInertia(const char* algorithm, const CompactModel& model, Data& data, VectorView q) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (!m.couplings.empty()) {
    detail::crba(model, data, q);
    return invertDense(algorithm, m, d);
  }
  invertTreeInertia(algorithm, m, d, q.data);
}

namespace detail {

DerivativeViews rneaDerivatives(const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a,
                                const Force<double>* fext, std::size_t count) {
  forceDerivatives("computeRNEADerivatives", model, data, q, v, a, fext, count, true);
  const DataImpl& d = data.impl();
  return {nullptr, d.dtau_dq, d.dtau_dv, d.M};
}

DerivativeViews abaDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                               std::size_t count) {
  const char* algorithm = "computeABADerivatives";
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const auto n = static_cast<Eigen::Index>(m.nv);
  using Matrix = Eigen::Map<Eigen::MatrixXd>;
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau});
  if (!m.couplings.empty()) {
    aba(model, data, q, v, tau, fext, count);
    const VectorView ddq{d.ddq, m.nv};
    rneaDerivatives(model, data, q, &v, &ddq, fext, count);
    invertDense(algorithm, m, d);
    Matrix(d.ddq_dq, n, n).noalias() = -Matrix(d.Minv, n, n).lazyProduct(Matrix(d.dtau_dq, n, n));
    Matrix(d.ddq_dv, n, n).noalias() = -Matrix(d.Minv, n, n).lazyProduct(Matrix(d.dtau_dv, n, n));
    return {d.ddq, d.ddq_dq, d.ddq_dv, d.Minv};
  }
  checkSize(algorithm, "tau", tau, m.nv);
  const Prepared x = prepare(algorithm, model, data, q, &v, nullptr, fext, count);
  const double* effective = lessDissipation(m, d, tau.data, x.in.v);
  const int failed = kernels::active().single.abaDerivatives(m, d, d.derivatives, x.in.v, effective, x.external, d.ddq, d.ddq_dq, d.ddq_dv, d.Minv);
  checkFactors(algorithm, m, failed, x.in.q);
  return {d.ddq, d.ddq_dq, d.ddq_dv, d.Minv};
}

const double* minverse(const CompactModel& model, Data& data, VectorView q) {
  const char* algorithm = "computeMinverse";
  checkData(algorithm, model, data, Need::derivatives);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (m.couplings.empty()) evaluateJoints(m, d, readInputs(algorithm, model, data, q, nullptr, nullptr).q, nullptr);
  inverseInertia(algorithm, model, data, q);
  return d.Minv;
}

}  // namespace detail

}  // namespace dyn
