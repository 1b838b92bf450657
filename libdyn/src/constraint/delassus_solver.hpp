// SPDX-License-Identifier: BSD-2-Clause
// Solves D x = b for the Delassus matrix D = J M^-1 J^T, which is positive semidefinite, and singular where constraints repeat each other.
#pragma once

#include "kernels/constraint/constraint_workspace.hpp"

#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// The factors of one matrix: its inverse if D is regular. Otherwise D = C C^T to rounding, where C has as many columns as D has rank, and solutions
/// have the least norm among the least-squares solutions: D^+ = C (C^T C)^-2 C^T.
class DelassusSolver {
 public:
  void layOut(int rows, Arena& arena);

  /// Factors D = x.delassus, or D + mu 1, which is regular, if settings.mu > 0. A pivot not above settings.rank_tolerance times x.bound counts as
  /// zero, so that rounding errors are not divided by. O(rows^3).
  void factor(kernels::ConstraintWorkspace& x, const ConstraintSettings& settings);

  /// x = D^+ b by the last factors, improved by iteration if D is singular. With mu, proximal iterations run until D x = b to settings.tolerance, or
  /// until they improve no more. Vectors have room for a pack; x and b may not overlap. Returns the number of iterations.
  int solve(const double* b, double* x);

  /// out = D x - b; returns its largest entry.
  double residual(const double* x, const double* b, double* out) const;
  int rank() const { return rank_; }
  bool regular() const { return regular_ && !(settings_.mu > 0); }

 private:
  void factorSingular();
  void apply(const double* b, double* x) const;  ///< x by the factors, without iterations
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
