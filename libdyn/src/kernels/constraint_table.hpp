// The kernels of constraints compiled for one instruction set, as table.hpp has the others: apart, so that neither rebuilds the other.
#pragma once

#include "kernels/constrained_inverse.hpp"
#include "kernels/constraint_workspace.hpp"
#include "kernels/row_derivatives.hpp"
#include "kernels/table.hpp"

namespace dyn::kernels {

constexpr std::size_t constraintLayoutStamp() {
  return (((sizeof(PackedConstraints) + sizeof(PackedFrameConstraint)) * 1000003 + sizeof(ConstrainedBody) + sizeof(ConstrainedChain) +
           sizeof(ConstrainedStripDof)) *
              1000003 +
          sizeof(ConstraintWorkspace) + sizeof(ChainState)) *
             1000003 +
         sizeof(ConstrainedInverse) + sizeof(RowState) + sizeof(RowMotion);
}

/// The recursions on bodies in the memory where `articulate` or `placeOutward` left them: a Workspace<double>, or the scratch of strips.
struct ConstraintRecursions {
  void (*locate)(const CompactImpl&, void* memory, const PackedConstraints&, const double* v, RowRates, ConstraintWorkspace&);
  void (*sweep)(const CompactImpl&, void* memory, const PackedConstraints&, bool eliminated, ConstraintWorkspace&);
  void (*yieldTo)(const CompactImpl&, void* memory, const PackedConstraints&, Force<double>* F, const double* shares);
  void (*takeYielded)(const CompactImpl&, void* memory, const PackedConstraints&, const ConstraintWorkspace&);
  void (*takeAccelerations)(const CompactImpl&, void* memory, const PackedConstraints&, ConstraintWorkspace&);
  void (*forgetForces)(const CompactImpl&, void* memory, const PackedConstraints&);
};

/// Vectors of one number a row have room for a pack, with zeros in it.
struct ConstraintKernels {
  std::size_t layout;  ///< constraintLayoutStamp(), as Kernels::layout
  ConstraintRecursions single, strips;
  void (*placeFrames)(const CompactImpl&, const PackedConstraints&, RowRates, FrameRows*, const RowMotion&, ConstraintWorkspace&);
  void (*frameAccelerations)(const PackedConstraints&, const FrameRows*, const ConstraintWorkspace&, double* out);
  void (*delassusMatrix)(const PackedConstraints&, ConstraintWorkspace&);
  void (*yieldToRows)(const PackedConstraints&, const double* lambda, ConstraintWorkspace&);
  void (*rowsOfYielded)(const PackedConstraints&, const ConstraintWorkspace&, double* out);
  /// The inverse of the Delassus matrix with mu on its diagonal; false where a pivot is not above tolerance times its bound.
  bool (*invertDelassus)(int rows, ConstraintWorkspace&, double mu, double tolerance);
  void (*timesRows)(int rows, std::ptrdiff_t stride, const double* A, const double* x, double* out);
  PointMotion (*pointColumns)(const CompactImpl&, const DerivativeWorkspace<double>&, int body, const Vec3<double>& lever, const int* path,
                              StoredColumn* out);
  void (*rowDerivatives)(const PackedFrameConstraint&, const RowState&, const StoredColumn* const* columns, const Rows<double>& turning,
                         const RowDerivatives& out);
  void (*invertConstrained)(const double* M_inverse, const double* J, DofRuns moving, ConstrainedInverse, double* x_by_tau, double* lambda_by_tau);
  /// Of one matrix for each right-hand side, or two.
  void (*solveConstrained[2])(ConstrainedInverse, ColumnPattern, ConstrainedColumns);
};

/// Of the table in use.
inline const ConstraintKernels& constraintKernels() { return *active().constraints; }

}  // namespace dyn::kernels
