#include "algorithm/inputs.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/table.hpp"

#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/error.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

void check(const char* algorithm, const CompactModel& model, const Data& data) {
  checkData(algorithm, model, data, Need::derivatives);
  if (!model.impl().couplings.empty())
    throw Error(ErrorCode::argument, std::string(algorithm) +
                                         ": the model has joints that follow others, so M has entries between distant joints and no factors "
                                         "that follow the tree; factor the result of crba instead");
}

kernels::FactorProduct kernelsOwn(Product product) {
  switch (product) {
    case Product::inverse:
      return kernels::FactorProduct::inverse;
    case Product::mass_matrix:
      return kernels::FactorProduct::mass_matrix;
    case Product::upper:
      return kernels::FactorProduct::upper;
    default:
      return kernels::FactorProduct::lower;
  }
}

void times(const CompactImpl& m, DataImpl& d, Product product, double* x) {
  std::copy(x, x + m.nv, d.column);
  kernels::active().single.factorTimes(m, d.derivatives, kernelsOwn(product), d.column);
  std::copy(d.column, d.column + m.nv, x);
}

}  // namespace

void choleskyDecompose(const CompactModel& model, Data& data) {
  check("cholesky::decompose", model, data);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const int failed = kernels::active().single.choleskyDecompose(m, d.derivatives, d.M);
  if (failed == 0 || !kernels::allFinite(d.M, static_cast<std::ptrdiff_t>(m.nv) * m.nv)) return;  // NaN of a state spreads
  checkFactors("cholesky::decompose", m, m.dof_body[static_cast<std::size_t>(failed - 1)]);
}

void choleskyTimes(const CompactModel& model, Data& data, Product product, const MatrixOut& X) {
  check("cholesky", model, data);
  checkShape("cholesky", "X", X, model.nv(), static_cast<int>(X.cols()));
  for (std::ptrdiff_t k = 0; k < X.cols(); ++k) times(model.impl(), data.impl(), product, X.column(k));
}

const double* forwardDynamics(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau) {
  check("forwardDynamics", model, data);
  checkSize("forwardDynamics", "tau", tau, model.nv());
  DataImpl& d = data.impl();
  keepArguments(data, {.q = &q, .v = &v, .tau = &tau});
  const double* bias = nonLinearEffects(model, data, q, v);
  for (int k = 0; k < model.nv(); ++k) d.ddq[k] = tau.data[k] - bias[k];
  crba(model, data, q);
  choleskyDecompose(model, data);
  times(model.impl(), d, Product::inverse, d.ddq);
  return d.ddq;
}

}  // namespace dyn::detail
