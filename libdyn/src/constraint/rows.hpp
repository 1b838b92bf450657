// Where constraints are, how fast they are violated, and what their forces do: everything about rows that one pass from each constraint to
// the world finds.
#pragma once

#include "compile/constraints.hpp"
#include "data/data_impl.hpp"
#include "kernels/constraint_workspace.hpp"
#include "kernels/row_derivatives.hpp"

namespace dyn {

/// Bias of a row's acceleration beside what the kernel's sweep finds, its velocity and its error of position.
struct RowMotion {
  double* bias;
  double* velocity;
  double* error;
};

/// Once the kernel has located chains. q and v in expanded coordinates; v may be null (at rest).
void locateRows(const CompactImpl& m, const PackedConstraints& c, const kernels::ConstraintWorkspace& x, const double* q, const double* v,
                FrameRows* frames, const RowMotion& rows);

/// Writes the rows' unit forces for the kernel's sweep.
void writeRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, kernels::ConstraintWorkspace& x);

/// The same with forces of the rows: one force a body of the constraints, and shares of their degrees of freedom.
void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* shares);

/// Accelerations of the rows by those of chains and joints, without their bias.
void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const double* q,
                      const kernels::ConstraintWorkspace& x, double* out);

/// What gravity adds to the rows' accelerations of a sweep in which the world falls up.
void addGravity(const CompactImpl& m, const PackedConstraints& c, const FrameRows* frames, const kernels::ConstraintWorkspace& x,
                double* accelerations);

}  // namespace dyn
