// The arena behind ConstraintData.
#pragma once

#include "constraint/delassus_solver.hpp"
#include "constraint/rows.hpp"

#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// Vectors are of one number a row.
struct ConstraintDataImpl {
  explicit ConstraintDataImpl(const ConstraintSet& s) : set(s) {}

  ConstraintSet set;
  PackMemory block;
  FrameRows* frames = nullptr;
  kernels::ConstraintWorkspace workspace;
  DelassusSolver solver;
  bool in_strips = false;  ///< the last recursion, whose rest is to follow
  RowMotion motion{};
  double* lambda = nullptr;
  double* wanted = nullptr;  ///< right-hand side of the equation for lambda
  double* step = nullptr;    ///< a correction of lambda
  double* left = nullptr;    ///< what of it is not met
  double* J = nullptr;       ///< rows x nv, column-major
  double* X = nullptr;       ///< nv x rows, M^-1 J^T
  double* gamma = nullptr;
  double* expanded = nullptr;  ///< nvx
  double* v_after = nullptr;   ///< nv
  double* q = nullptr;         ///< nq, twice
};

}  // namespace dyn
