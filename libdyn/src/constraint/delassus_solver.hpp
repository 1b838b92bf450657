// D x = b for the Delassus matrix D = J M^-1 J^T: positive semidefinite, and singular where constraints repeat each other.
#pragma once

#include "kernels/workspace.hpp"

#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// Factors of one matrix. Where D is regular, D = L diag L^T. Otherwise D = C C^T to rounding with C of as many columns as D has rank, and
/// solutions are of least norm among those of least squares: D^+ = C (C^T C)^-2 C^T.
class DelassusSolver {
 public:
  void carve(int rows, Arena& arena);

  /// D: rows `stride` apart. A pivot below tolerance times bound (by row: what D's diagonal would be if nothing cancelled) ends the
  /// factorisation, so that what is rounding is not divided by. With mu, of D + mu 1, which is regular. Returns the rank. O(rows^3).
  int factor(const double* D, std::ptrdiff_t stride, const double* bound, const ConstraintSettings& settings);

  /// x = D^+ b by the last factors, improved once where D is singular; with mu by proximal iterations, x = argmin, until D x = b to the
  /// tolerance of the settings. x and b may not overlap. Returns the number of iterations.
  int solve(const double* b, double* x);

  /// out = D x - b; returns its largest entry.
  double residual(const double* x, const double* b, double* out) const;
  int rank() const { return rank_; }

 private:
  bool factorRegular(double mu);
  void factorSingular();
  void apply(double* x) const;  ///< by the factors alone
  double* entry(double* matrix, int row) const { return matrix + static_cast<std::ptrdiff_t>(row) * n_; }
  const double* entry(const double* matrix, int row) const { return matrix + static_cast<std::ptrdiff_t>(row) * n_; }

  int n_ = 0, rank_ = 0;
  bool regular_ = true;
  ConstraintSettings settings_;
  const double* D_ = nullptr;
  const double* bound_ = nullptr;
  std::ptrdiff_t stride_ = 0;
  double* L_ = nullptr;         ///< rows of L, or C
  double* gram_ = nullptr;      ///< factors of C^T C, rows of a lower triangle
  double* inverse_ = nullptr;   ///< 1 / diag
  double* work_ = nullptr;      ///< 3 n
};

}  // namespace dyn
