#include "constraint/delassus_solver.hpp"

#include <algorithm>
#include <cmath>

namespace dyn {

namespace {

/// In place, rows of a lower triangle, n apart.
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

void DelassusSolver::carve(int rows, Arena& arena) {
  n_ = rows;
  const auto n = static_cast<std::size_t>(rows);
  arena.take(L_, n * n);
  arena.take(gram_, n * n);
  arena.take(inverse_, n);
  arena.take(work_, 3 * n);
}

int DelassusSolver::factor(const double* D, std::ptrdiff_t stride, const double* bound, const ConstraintSettings& settings) {
  D_ = D;
  stride_ = stride;
  bound_ = bound;
  settings_ = settings;
  rank_ = n_;
  regular_ = factorRegular(settings.mu);
  if (!regular_) factorSingular();
  return rank_;
}

/// L diag L^T by columns of the lower triangle; false where a pivot vanishes.
bool DelassusSolver::factorRegular(double mu) {
  for (int j = 0; j < n_; ++j) {
    // Row j of L times the diagonal, then row j of L.
    double* row = entry(L_, j);
    double pivot = D_[j * stride_ + j] + mu;
    for (int i = 0; i < j; ++i) {
      const double* other = entry(L_, i);
      double sum = D_[j * stride_ + i];
      for (int k = 0; k < i; ++k) sum -= row[k] * other[k];
      row[i] = sum;
    }
    for (int i = 0; i < j; ++i) {
      const double scaled = row[i] * inverse_[i];
      pivot -= scaled * row[i];
      row[i] = scaled;
    }
    // NaN goes on, to come out as NaN.
    if (pivot <= settings_.rank_tolerance * bound_[j] && !(mu > 0)) return false;
    inverse_[j] = 1 / pivot;
    row[j] = pivot;
  }
  return true;
}

/// Cholesky by the largest pivots, as far as they are more than rounding: rows of C, in the order of D.
void DelassusSolver::factorSingular() {
  double* left = work_;  // of the diagonal
  for (int i = 0; i < n_; ++i) left[i] = D_[i * stride_ + i];
  std::fill_n(L_, static_cast<std::ptrdiff_t>(n_) * n_, 0.0);
  for (rank_ = 0; rank_ < n_; ++rank_) {
    int best = -1;
    double ratio = settings_.rank_tolerance;
    for (int i = 0; i < n_; ++i)
      if (left[i] > ratio * bound_[i]) {
        best = i;
        ratio = left[i] / bound_[i];
      }
    if (best < 0) break;
    const double pivot = std::sqrt(left[best]);
    const double* chosen = entry(L_, best);
    for (int i = 0; i < n_; ++i) {
      if (i == best || left[i] == 0) continue;
      double* row = entry(L_, i);
      double sum = D_[i * stride_ + best];
      for (int k = 0; k < rank_; ++k) sum -= row[k] * chosen[k];
      row[rank_] = sum / pivot;
      left[i] = std::max(left[i] - row[rank_] * row[rank_], 0.0);
    }
    entry(L_, best)[rank_] = pivot;
    left[best] = 0;
  }
  for (int i = 0; i < rank_; ++i)
    for (int j = 0; j <= i; ++j) {
      double sum = 0;
      for (int k = 0; k < n_; ++k) sum += entry(L_, k)[i] * entry(L_, k)[j];
      entry(gram_, i)[j] = sum;
    }
  factorTriangle(gram_, rank_, n_);
}

void DelassusSolver::apply(double* x) const {
  if (regular_) {
    for (int i = 0; i < n_; ++i)
      for (int k = 0; k < i; ++k) x[i] -= entry(L_, i)[k] * x[k];
    for (int i = 0; i < n_; ++i) x[i] *= inverse_[i];
    for (int i = n_ - 1; i >= 0; --i)
      for (int k = 0; k < i; ++k) x[k] -= entry(L_, i)[k] * x[i];
    return;
  }
  double* y = work_;
  std::fill_n(y, rank_, 0.0);
  for (int i = 0; i < n_; ++i)
    for (int k = 0; k < rank_; ++k) y[k] += entry(L_, i)[k] * x[i];
  solveTriangle(gram_, rank_, n_, y);
  solveTriangle(gram_, rank_, n_, y);
  for (int i = 0; i < n_; ++i) {
    x[i] = 0;
    for (int k = 0; k < rank_; ++k) x[i] += entry(L_, i)[k] * y[k];
  }
}

double DelassusSolver::residual(const double* x, const double* b, double* out) const {
  double largest = 0;
  for (int i = 0; i < n_; ++i) {
    double sum = -b[i];
    for (int k = 0; k < n_; ++k) sum += D_[i * stride_ + k] * x[k];
    out[i] = sum;
    if (!(std::abs(sum) <= largest)) largest = std::abs(sum);
  }
  return largest;
}

int DelassusSolver::solve(const double* b, double* x) {
  std::copy_n(b, n_, x);
  apply(x);
  const bool proximal = settings_.mu > 0;
  if (regular_ && !proximal) return 1;
  double* step = work_ + n_;
  // What the constraints contradict each other in stays: no iteration takes it away, and it must not build up.
  const int most = proximal ? settings_.max_iterations : 3;
  double before = HUGE_VAL;
  int iterations = 1;
  for (; iterations < most; ++iterations) {
    const double error = residual(x, b, step);
    if (!(error < before) || (proximal && error <= settings_.tolerance)) break;
    before = error;
    apply(step);
    for (int i = 0; i < n_; ++i) x[i] -= step[i];
  }
  return iterations;
}

}  // namespace dyn
