// SPDX-License-Identifier: BSD-2-Clause
// The kernels of constraints compiled for one instruction set. table.hpp has the other kernels; in separate files, a change of one does not rebuild
// the other.
#pragma once

#include "kernels/constraint/constrained_inverse.hpp"
#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/constraint/row_derivatives.hpp"
#include "kernels/isa/table.hpp"

namespace dyn::kernels {

/// The rows of a block of states. Arrays have one number for each row and state; those of one row are side by side, and there is room for more rows.
struct RowsOfStates {
  RowMotion motion;
  double* projection;  ///< `room` rows for each degree of freedom of the constraints' bodies
  double *carried, *bound;
  double* delassus;  ///< `stride` entries for each row of the matrix
  double *forces, *gamma, *wanted;
  double* irregular;  ///< one number for each state: not 0 where invert() found that the rows depend on each other
  std::ptrdiff_t stride, room;
};

constexpr std::size_t constraintLayoutStamp() {
  return (((sizeof(PackedConstraints) + sizeof(PackedFrameConstraint)) * 1000003 + sizeof(ConstrainedBody) + sizeof(ConstrainedChain) +
           sizeof(ConstrainedLaneGroupDof)) *
              1000003 +
          sizeof(ConstraintWorkspace) + sizeof(ChainState)) *
             1000003 +
         sizeof(ConstrainedInverse) + sizeof(RowState) + sizeof(RowMotion) + sizeof(RowsOfStates);
}

/// The recursions over bodies. `memory` holds what `articulate` or `placeOutward` wrote: a Workspace<double>, or the scratch of lane groups.
struct ConstraintRecursions {
  void (*locate)(const CompactImpl&, void* memory, const PackedConstraints&, const double* v, RowRates, ConstraintWorkspace&);
  void (*sweep)(const CompactImpl&, void* memory, const PackedConstraints&, bool eliminated, ConstraintWorkspace&);
  void (*respondTo)(const CompactImpl&, void* memory, const PackedConstraints&, Force<double>* F, const double* projections);
  void (*takeResponse)(const CompactImpl&, void* memory, const PackedConstraints&, const ConstraintWorkspace&);
  void (*takeAccelerations)(const CompactImpl&, void* memory, const PackedConstraints&, ConstraintWorkspace&);
  void (*forgetForces)(const CompactImpl&, void* memory, const PackedConstraints&);
};

/// Constrained dynamics of a block of states, in the order of the calls. `scratch` is that of BlockKernels<double>, `memory` has `bytes` bytes of
/// zeros for the constraints, and both belong to one thread. For models without dependent joints.
struct ConstraintStateKernels {
  std::size_t (*bytes)(const CompactImpl&, const PackedConstraints&);
  RowsOfStates (*prepare)(const CompactImpl&, const PackedConstraints&, char* memory);
  /// Eliminates the joints, for q, v and tau of the block, and places the rows, which move with v. Rows on joints are left to the caller, who writes
  /// their motion and adds to `projection`.
  void (*articulate)(const CompactImpl&, char* scratch, const PackedConstraints&, const ColumnsIn<double>& v, RowRates, Block<double>&, char* memory);
  /// Computes carried, bound, delassus, and gamma as rowsOfResponse().
  void (*sweep)(const CompactImpl&, const PackedConstraints&, char* memory);
  /// Invert the Delassus matrices, for lambda = D^-1 wanted into `forces`.
  /// @{
  void (*invert)(const PackedConstraints&, double tolerance, char* memory);
  void (*solve)(const PackedConstraints&, char* memory);
  /// @}
  void (*respondToRows)(const PackedConstraints&, char* memory);   ///< takes `forces`
  void (*rowsOfResponse)(const PackedConstraints&, char* memory);  ///< writes `gamma`
  /// Writes the accelerations under this gravity to the block's first result.
  void (*accelerate)(const CompactImpl&, char* scratch, const PackedConstraints&, const Vec3<double>& gravity, Block<double>&, char* memory);
};

/// Vectors with one number per constraint row have room for a pack at the end, filled with zeros.
struct ConstraintKernels {
  std::size_t layout;  ///< constraintLayoutStamp(), like Kernels::layout
  ConstraintRecursions single, lane_groups;
  ConstraintStateKernels states;
  void (*placeFrames)(const CompactImpl&, const PackedConstraints&, RowRates, FrameRows*, const RowMotion&, ConstraintWorkspace&);
  void (*frameAccelerations)(const PackedConstraints&, const FrameRows*, const ConstraintWorkspace&, double* out);
  void (*delassusMatrix)(const PackedConstraints&, ConstraintWorkspace&);
  void (*respondToRows)(const PackedConstraints&, const double* lambda, ConstraintWorkspace&);
  void (*rowsOfResponse)(const PackedConstraints&, const ConstraintWorkspace&, double* out);
  /// Inverts the Delassus matrix with mu added to its diagonal. Returns false if a pivot is not above tolerance times its bound.
  bool (*invertDelassus)(int rows, ConstraintWorkspace&, double mu, double tolerance);
  void (*timesRows)(int rows, std::ptrdiff_t stride, const double* A, const double* x, double* out);
  PointMotion (*pointColumns)(const CompactImpl&, const DerivativeWorkspace<double>&, int body, const Vec3<double>& arm, const int* path,
                              StoredColumn* out);
  void (*rowDerivatives)(const PackedFrameConstraint&, const RowState&, const StoredColumn* const* columns, const Rows<double>& turning,
                         const RowDerivatives& out);
  void (*invertConstrained)(const double* M_inverse, const double* J, DofRuns moving, ConstrainedInverse, double* x_by_tau, double* lambda_by_tau);
  /// [0] takes one matrix of each kind in ConstrainedColumns, [1] takes two.
  void (*solveConstrained[2])(ConstrainedInverse, ColumnPattern, ConstrainedColumns);
};

/// The constraint kernels of the table in use.
inline const ConstraintKernels& constraintKernels() { return *active().constraints; }

}  // namespace dyn::kernels
