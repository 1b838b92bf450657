// The kernels of constraints compiled for one instruction set, as table.hpp has the others: apart, so that neither rebuilds the other.
#pragma once

#include "kernels/constrained_inverse.hpp"
#include "kernels/constraints.hpp"
#include "kernels/row_derivatives.hpp"
#include "kernels/table.hpp"

namespace dyn::kernels {

constexpr std::size_t constraintLayoutStamp() {
  return (((sizeof(PackedConstraints) + sizeof(PackedFrameConstraint)) * 1000003 + sizeof(ConstrainedBody) + sizeof(ConstrainedChain)) * 1000003 +
          sizeof(ConstraintWorkspace)) *
             1000003 +
         sizeof(ConstrainedInverse) + sizeof(RowState);
}

/// Vectors of one number a row have room for a pack, with zeros in it.
struct ConstraintKernels {
  std::size_t layout;  ///< constraintLayoutStamp(), as Kernels::layout
  void (*sweep)(const CompactImpl&, const Workspace<double>&, const PackedConstraints&, bool eliminated, ConstraintWorkspace&);
  void (*delassusMatrix)(const PackedConstraints&, ConstraintWorkspace&);
  /// The inverse of the Delassus matrix with mu on its diagonal; false where a pivot is not above tolerance times its bound.
  bool (*invertDelassus)(int rows, ConstraintWorkspace&, double mu, double tolerance);
  void (*timesRows)(int rows, std::ptrdiff_t stride, const double* A, const double* x, double* out);
  void (*addForces)(const PackedConstraints&, const ConstraintWorkspace&, const double* lambda, Workspace<double>&);
  void (*accelerate)(const CompactImpl&, Workspace<double>&, const PackedConstraints&, const Vec3<double>& gravity, ConstraintWorkspace&);
  PointMotion (*pointColumns)(const CompactImpl&, const DerivativeWorkspace<double>&, int body, const Vec3<double>& lever, const int* path,
                              StoredColumn* out);
  void (*rowDerivatives)(const PackedFrameConstraint&, const RowState&, const StoredColumn* const* columns, const Rows<double>& turning,
                         const RowDerivatives& out);
  void (*invertConstrained)(const double* M_inverse, const double* J, DofRuns moving, ConstrainedInverse);
  /// Of one matrix for each right-hand side, or two.
  void (*solveConstrained[2])(ConstrainedInverse, ColumnPattern, ConstrainedColumns);
  /// What articulate has left of the constraints' bodies, out of the lanes; and what their forces add, back into them.
  void (*readBodies)(const CompactImpl&, const char* scratch, const PackedConstraints&, Workspace<double>&);
  void (*writeShares)(const Workspace<double>&, const PackedConstraints&, char* scratch);
};

/// Of the table in use.
inline const ConstraintKernels& constraintKernels() { return *active().constraints; }

}  // namespace dyn::kernels
