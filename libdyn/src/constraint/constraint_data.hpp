// SPDX-License-Identifier: BSD-2-Clause
// The arena behind ConstraintData.
#pragma once

#include "constraint/cone_solver.hpp"
#include "constraint/delassus_solver.hpp"
#include "constraint/rows.hpp"
#include "kernels/constraint/constrained_inverse.hpp"
#include "kernels/constraint/row_derivatives.hpp"

#include <dyn/constraint/constraint_set.hpp>

#include <optional>
#include <vector>

namespace dyn {

/// The entries of derivatives that can be non-zero, by the user's degrees of freedom.
struct DerivativePattern {
  explicit DerivativePattern(const ConstraintSet& set);
  DerivativePattern(const DerivativePattern&) = delete;  // `forces` and `moving` are parts of `all`
  DerivativePattern& operator=(const DerivativePattern&) = delete;
  std::vector<kernels::DofRun> all;
  std::vector<kernels::DofRuns> forces;  ///< for each column of the generalised forces' derivatives by q or v
  kernels::DofRuns moving;               ///< columns of J, and of the rows' derivatives
  std::vector<char> moves, twins;        ///< as in ColumnPattern
  bool forces_turn = false;              ///< some forces turn with their axes: see PackedFrameConstraint::forceTurns
  kernels::ColumnPattern columns() const { return {forces.data(), moves.data(), twins.data()}; }
};

/// Vectors have one number a row, unless a member says otherwise.
struct ConstraintDataImpl {
  ConstraintDataImpl(const ConstraintSet& s, Need n) : set(s), needs(n) {}

  ConstraintSet set;
  Need needs;
  PackMemory block;
  kernels::FrameRows* frames = nullptr;
  kernels::ConstraintWorkspace workspace;
  DelassusSolver solver;
  ConeSolver cone_solver;
  bool in_lane_groups = false;  ///< the last recursion was over lane groups, so its rest must be, too
  bool by_inertia = false;      ///< the last free motion was computed from M
  kernels::RowMotion motion{};
  double* lambda = nullptr;
  double* wanted = nullptr;  ///< right-hand side of the equation for lambda
  double* step = nullptr;    ///< a correction of lambda
  double* left = nullptr;    ///< residual of the equation
  double* J = nullptr;       ///< rows x nv, column-major
  double* X = nullptr;       ///< nv x rows, M^-1 J^T
  double* gamma = nullptr;
  double* expanded = nullptr;      ///< nvx
  double* v_after = nullptr;       ///< nv
  double* q = nullptr;             ///< nq, twice
  double* matrix = nullptr;        ///< rows x rows
  Force<double>* total = nullptr;  ///< one for each body of the constraints
  double* projections = nullptr;   ///< one for each degree of freedom of these bodies
  PackedCone* cones = nullptr;     ///< at most one for each row

  // With Need::derivatives only.
  kernels::StoredColumn* columns[2] = {};           ///< of a constraint's point on its two bodies, one for each slot
  Rows<double> turning;                             ///< 12 numbers for each slot, scratch
  double *row_by_q = nullptr, *row_by_v = nullptr;  ///< rows x nv
  double *lambda_dq = nullptr, *lambda_dv = nullptr, *lambda_dtau = nullptr;
  double *motion_dq = nullptr, *motion_dv = nullptr, *motion_dtau = nullptr;  ///< nv x nv
  Force<double>* fext = nullptr;                                              ///< one for each joint
  double* change = nullptr;                                                   ///< nv
  double* force = nullptr;                                                    ///< nv x nv, twice: derivatives of the generalised forces
  kernels::ConstrainedInverse inverse;
  std::optional<DerivativePattern> pattern;
};

}  // namespace dyn
