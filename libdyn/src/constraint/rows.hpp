// Where constraints are, how fast they are violated, and what their forces do: everything about rows that one pass from each constraint to
// the world finds. Rows of constraints between frames are the kernel's (frame_rows.hpp), those on joints are here.
#pragma once

#include "compile/constraints.hpp"
#include "data/data_impl.hpp"
#include "kernels/constraint_workspace.hpp"

namespace dyn {

/// Once the kernel has located chains: frames, the rows' motion, and their unit forces for the kernel's sweep. q and v in expanded coordinates; v
/// may be null (at rest).
void locateRows(const CompactImpl& m, const PackedConstraints& c, const double* q, const double* v, kernels::RowRates rates,
                kernels::FrameRows* frames, const kernels::RowMotion& rows, kernels::ConstraintWorkspace& x);

/// Forces of the rows, one number each: one force a body of the constraints, and shares of their degrees of freedom.
void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* shares);

/// Accelerations of the rows by those of chains and of degrees of freedom, without their bias; `out` has room for a pack.
void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q,
                      const kernels::ConstraintWorkspace& x, const double* ddq, double* out);

/// Of a body's joint: v that leads from one configuration to the other, and its derivatives by these, nv x nv row by row, where they are asked for.
void differenceOf(const CompactImpl& m, int body, const double* from, const double* to, double* v, double* J_from = nullptr, double* J_to = nullptr);

}  // namespace dyn
