// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/kkt.hpp"

#include "algorithm/crba.hpp"
#include "constraint/solution.hpp"
#include "kernels/isa/constraint_table.hpp"
#include "kernels/recursion/dense_factors.hpp"

#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/crba.hpp>

#include <algorithm>

namespace dyn {

void projectInertia(const char* algorithm, const CompactModel& model, Data& data, VectorView q, const VectorView* v, ConstraintDataImpl& c) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  detail::crba(model, data, q);
  const double* inertia = m.couplings.empty() ? d.M : d.Mx;
  for (std::ptrdiff_t k = 0; k < m.nvx; ++k) d.dof[k].inverse = 1 / inertia[(m.nvx + 1) * k];
  placeRows(algorithm, model, data, q, v, c);
  if (m.couplings.empty()) {
    detail::choleskyDecompose(model, data);
  } else {
    factorInertia(algorithm, m, d, d.M, c.expanded);
  }
  const std::ptrdiff_t rows = c.set.rows(), n = m.nv;
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    double* x = c.X + n * r;
    for (std::ptrdiff_t k = 0; k < n; ++k) x[k] = c.J[rows * k + r];
    solveInertia(model, data, x);
    double* row = c.workspace.delassus + c.workspace.stride * r;
    std::fill_n(row, rows, 0.0);
    addRowsOf(m, c, x, row);
  }
}

void solveInertia(const CompactModel& model, Data& data, double* x) {
  if (model.impl().couplings.empty()) {
    detail::choleskyTimes(model, data, detail::Product::inverse, MatrixOut(x, model.nv(), 1));
  } else {
    kernels::solveDense(model.impl(), data.impl().M, x);
  }
}

void addRowsOf(const CompactImpl& m, const ConstraintDataImpl& c, const double* x, double* out) {
  const std::ptrdiff_t rows = c.set.rows();
  for (std::ptrdiff_t k = 0; k < m.nv; ++k)
    for (std::ptrdiff_t r = 0; r < rows; ++r) out[r] += c.J[rows * k + r] * x[k];
}

void addMotionOf(const CompactImpl& m, const ConstraintDataImpl& c, const double* lambda, double* x) {
  for (std::ptrdiff_t r = 0; r < c.set.rows(); ++r)
    for (std::ptrdiff_t k = 0; k < m.nv; ++k) x[k] += lambda[r] * c.X[m.nv * r + k];
}

}  // namespace dyn
