// D x = b for the Delassus matrix D = J M^-1 J^T: positive semidefinite, and singular where constraints repeat each other.
#pragma once

#include "kernels/constraint_workspace.hpp"

#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// Factors of one matrix. Where D is regular, its inverse. Otherwise D = C C^T to rounding with C of as many columns as D has rank, and
/// solutions are of least norm among those of least squares: D^+ = C (C^T C)^-2 C^T.
class DelassusSolver {
 public:
  void carve(int rows, Arena& arena);

  /// x.delassus. A pivot below tolerance times x.bound ends the factorisation, so that what is rounding is not divided by. With mu, of
  /// D + mu 1, which is regular. O(rows^3).
  void factor(kernels::ConstraintWorkspace& x, const ConstraintSettings& settings);

  /// x = D^+ b by the last factors, improved where D is singular; with mu by proximal iterations until D x = b to the tolerance of the
  /// settings, or they get no better. Vectors have room for a pack; x and b may not overlap. Returns the number of iterations.
  int solve(const double* b, double* x);

  /// out = D x - b; returns its largest entry.
  double residual(const double* x, const double* b, double* out) const;
  int rank() const { return rank_; }
  bool regular() const { return regular_ && !(settings_.mu > 0); }

 private:
  void factorSingular();
  void apply(const double* b, double* x) const;  ///< x by the factors alone
  double* entry(double* matrix, int row) const { return matrix + static_cast<std::ptrdiff_t>(row) * n_; }

  int n_ = 0, rank_ = 0;
  bool regular_ = true;
  ConstraintSettings settings_;
  const kernels::ConstraintWorkspace* x_ = nullptr;
  double* C_ = nullptr;
  double* gram_ = nullptr;  ///< factors of C^T C, rows of a lower triangle
  double* left_ = nullptr;
  double* step_ = nullptr;
  double* correction_ = nullptr;
};

}  // namespace dyn
