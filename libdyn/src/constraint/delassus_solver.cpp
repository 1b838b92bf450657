// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/delassus_solver.hpp"

#include "kernels/isa/constraint_table.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

/// The Cholesky factor of A in place: the lower triangle, with rows `stride` apart.
void factorTriangle(double* A, int n, int stride) {
  for (int j = 0; j < n; ++j) {
    double* row = A + static_cast<std::ptrdiff_t>(j) * stride;
    for (int i = 0; i <= j; ++i) {
      const double* other = A + static_cast<std::ptrdiff_t>(i) * stride;
      double sum = row[i];
      for (int k = 0; k < i; ++k) sum -= row[k] * other[k];
      row[i] = i < j ? sum / other[i] : std::sqrt(sum);
    }
  }
}

void solveTriangle(const double* A, int n, int stride, double* x) {
  for (int i = 0; i < n; ++i) {
    const double* row = A + static_cast<std::ptrdiff_t>(i) * stride;
    for (int k = 0; k < i; ++k) x[i] -= row[k] * x[k];
    x[i] /= row[i];
  }
  for (int i = n - 1; i >= 0; --i) {
    x[i] /= A[static_cast<std::ptrdiff_t>(i) * stride + i];
    for (int k = 0; k < i; ++k) x[k] -= A[static_cast<std::ptrdiff_t>(i) * stride + k] * x[i];
  }
}

}  // namespace

void DelassusSolver::layOut(int rows, Arena& arena) {
  n_ = rows;
  const auto n = static_cast<std::size_t>(rows);
  arena.take(C_, n * n);
  arena.take(gram_, n * n);
  arena.take(left_, n);
  arena.take(step_, n + most_lanes);
  arena.take(correction_, n + most_lanes);
}

void DelassusSolver::factor(kernels::ConstraintWorkspace& x, const ConstraintSettings& settings) {
  x_ = &x;
  settings_ = settings;
  rank_ = n_;
  regular_ = kernels::constraintKernels().invertDelassus(n_, x, settings.mu, settings.rank_tolerance);
  if (!regular_) factorSingular();
}

/// Pivoted Cholesky: chooses the largest pivots and stops when the rest is rounding. C has its rows in the order of D.
void DelassusSolver::factorSingular() {
  const double *D = x_->delassus, *bound = x_->bound;
  const std::ptrdiff_t stride = x_->stride;
  double* left = left_;  // the rest of the diagonal
  for (int i = 0; i < n_; ++i) left[i] = D[i * stride + i];
  std::fill_n(C_, static_cast<std::ptrdiff_t>(n_) * n_, 0.0);
  for (rank_ = 0; rank_ < n_; ++rank_) {
    int best = -1;
    double ratio = settings_.rank_tolerance;
    for (int i = 0; i < n_; ++i)
      if (left[i] > ratio * bound[i]) {
        best = i;
        ratio = left[i] / bound[i];
      }
    if (best < 0) break;
    const double pivot = std::sqrt(left[best]);
    const double* chosen = entry(C_, best);
    for (int i = 0; i < n_; ++i) {
      if (i == best || left[i] == 0) continue;
      double* row = entry(C_, i);
      double sum = D[i * stride + best];
      for (int k = 0; k < rank_; ++k) sum -= row[k] * chosen[k];
      row[rank_] = sum / pivot;
      left[i] = std::max(left[i] - row[rank_] * row[rank_], 0.0);
    }
    entry(C_, best)[rank_] = pivot;
    left[best] = 0;
  }
  for (int i = 0; i < rank_; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < n_; ++k) sum += entry(C_, k)[i] * entry(C_, k)[j];
      entry(gram_, i)[j] = sum;
    }
  factorTriangle(gram_, rank_, n_);
}

void DelassusSolver::apply(const double* b, double* x) const {
  if (regular_) return kernels::constraintKernels().timesRows(n_, x_->stride, x_->inverse, b, x);
  double* y = left_;
  std::fill_n(y, rank_, 0.0);
  for (int i = 0; i < n_; ++i)
    for (int k = 0; k < rank_; ++k) y[k] += entry(C_, i)[k] * b[i];
  solveTriangle(gram_, rank_, n_, y);
  solveTriangle(gram_, rank_, n_, y);
  for (int i = 0; i < n_; ++i) {
    x[i] = 0;
    for (int k = 0; k < rank_; ++k) x[i] += entry(C_, i)[k] * y[k];
  }
}

double DelassusSolver::residual(const double* x, const double* b, double* out) const {
  kernels::constraintKernels().timesRows(n_, x_->stride, x_->delassus, x, out);
  double largest = 0;
  for (int i = 0; i < n_; ++i) {
    out[i] -= b[i];
    if (!(std::abs(out[i]) <= largest)) largest = std::abs(out[i]);
  }
  return largest;
}

int DelassusSolver::solve(const double* b, double* x) {
  apply(b, x);
  const bool proximal = settings_.mu > 0;
  if (regular_ && !proximal) return 1;
  // If constraints contradict each other, a residual remains, which no iteration removes. The iteration must stop before it builds up.
  const int most = proximal ? settings_.max_iterations : 3;
  double before = HUGE_VAL;
  int iterations = 1;
  for (; iterations < most; ++iterations) {
    const double error = residual(x, b, step_);
    if (!(error < before) || (proximal && error <= settings_.tolerance)) break;
    before = error;
    apply(step_, correction_);
    for (int i = 0; i < n_; ++i) x[i] -= correction_[i];
  }
  return iterations;
}

}  // namespace dyn
