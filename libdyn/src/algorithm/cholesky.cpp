// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/isa/table.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

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

void times(const CompactImpl& m, DataImpl& d, Product product, const MatrixOut& X) {
  kernels::active().single.factorTimes(m, d.derivatives, kernelsOwn(product), X.column(0), X.cols(), X.stride());
}

}  // namespace

void choleskyDecompose(const CompactModel& model, Data& data) {
  check("cholesky::decompose", model, data);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const int failed = kernels::active().single.choleskyDecompose(m, d.derivatives, d.M);
  if (failed == 0 || !kernels::allFinite(d.M, static_cast<std::ptrdiff_t>(m.nv) * m.nv)) return;  // NaN in the state spreads
  checkFactors("cholesky::decompose", m, m.dof_body[static_cast<std::size_t>(failed - 1)]);
}

void choleskyTimes(const CompactModel& model, Data& data, Product product, const MatrixOut& X) {
  check("cholesky", model, data);
  checkShape("cholesky", "X", X, model.nv(), static_cast<int>(X.cols()));
  times(model.impl(), data.impl(), product, X);
}

double conditionOfMassMatrix(const CompactModel& model, Data& data) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  const bool coupled = !m.couplings.empty();
  checkData("conditionOfMassMatrix", model, data, coupled ? Need::mass_matrix : Need::derivatives);
  const int n = m.nv;
  if (n == 0) return 1;
  if (coupled) {
    int failed = 0;
    std::copy(d.M, d.M + static_cast<std::ptrdiff_t>(n) * n, d.Mx);
    kernels::factorDense(m, d.Mx, d.ax, &failed);
    if (failed != 0) return std::numeric_limits<double>::infinity();
  }
  const auto entry = [&](int i, int j) { return d.M[static_cast<std::ptrdiff_t>(j) * n + i]; };
  const auto scale = [&](int i) { return std::sqrt(entry(i, i)); };
  double size = 0;
  for (int j = 0; j < n; ++j) {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += std::abs(entry(i, j)) / (scale(i) * scale(j));
    size = std::max(size, sum);
  }
  double *x = d.copied_a, *y = d.copied_tau;
  const auto solve = [&](auto&& right) {  // y = D M^-1 D right, where D holds the roots of M's diagonal
    for (int k = 0; k < n; ++k) y[k] = scale(k) * right(k);
    if (coupled) {
      kernels::solveDense(m, d.Mx, y);
    } else {
      times(m, d, Product::inverse, {y, n, 1});
    }
    for (int k = 0; k < n; ++k) y[k] *= scale(k);
  };
  const auto sum = [&] { return std::accumulate(y, y + n, 0.0, [](double total, double value) { return total + std::abs(value); }); };
  // The first estimate uses the vector of alternating signs. Then Hager's iteration moves to columns that promise a larger sum.
  solve([&](int k) { return (k % 2 == 0 ? 1 : -1) * (1 + static_cast<double>(k) / std::max(n - 1, 1)); });
  double inverse = 2 * sum() / (3 * n);
  std::fill(x, x + n, 1.0 / n);
  constexpr int most_columns = 5;
  for (int k = 0; k < most_columns; ++k) {
    solve([&](int i) { return x[i]; });
    inverse = std::max(inverse, sum());
    std::copy(y, y + n, d.copied_v);
    solve([&](int i) { return d.copied_v[i] >= 0 ? 1.0 : -1.0; });
    const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
    const auto best = std::max_element(y, y + n, larger) - y;
    if (std::abs(y[best]) <= std::inner_product(x, x + n, y, 0.0)) break;
    std::fill(x, x + n, 0.0);
    x[best] = 1;
  }
  return size * inverse;
}

const double* forwardDynamics(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau) {
  check("forwardDynamics", model, data);
  checkSize("forwardDynamics", "tau", tau, model.nv());
  DataImpl& d = data.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau});
  const double* bias = nonLinearEffects(model, data, q, v);
  for (int k = 0; k < model.nv(); ++k) d.ddq[k] = tau.data[k] - bias[k];
  crba(model, data, q);
  choleskyDecompose(model, data);
  times(model.impl(), d, Product::inverse, {d.ddq, model.nv(), 1});
  return d.ddq;
}

}  // namespace dyn::detail
