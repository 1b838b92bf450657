// SPDX-License-Identifier: BSD-2-Clause
// Positions, rates and forces of constraint rows, as one pass from each constraint to the world finds them. The kernels treat rows of constraints
// between frames (frame_rows.hpp); rows on joints are treated here.
#pragma once

#include "compile/constraints.hpp"
#include "data/data_impl.hpp"
#include "kernels/constraint/constraint_workspace.hpp"

namespace dyn {

/// Locates frames, and writes the rows' motion and their unit forces for the kernel's sweep. The kernel has located the chains. q and v are in
/// expanded coordinates; v may be null (at rest).
void locateRows(const CompactImpl& m, const PackedConstraints& c, const double* q, const double* v, kernels::RowRates rates,
                kernels::FrameRows* frames, const kernels::RowMotion& rows, kernels::ConstraintWorkspace& x);

/// The part of locateRows for rows on joints: writes their motion, and adds their unit forces to `projection`, `room` rows for each degree of freedom
/// of the constraints' bodies. Numbers of neighbouring rows are `step` apart.
void locateJointRows(const CompactImpl& m, const PackedConstraints& c, const double* q, const double* v, const kernels::RowMotion& rows,
                     double* projection, std::ptrdiff_t room, int step);

/// Sums the forces lambda of the rows: one force for each of the constraints' bodies, and one projection for each of their degrees of freedom.
void sumRowForces(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q, const double* lambda,
                  Force<double>* bodies, double* projections);

/// The accelerations of the rows from those of chains and of degrees of freedom, without the rows' bias. `out` has room for a pack.
void rowAccelerations(const CompactImpl& m, const PackedConstraints& c, const kernels::FrameRows* frames, const double* q,
                      const kernels::ConstraintWorkspace& x, const double* ddq, double* out);

/// The v that leads a body's joint from one configuration to the other. Unless null, J_from and J_to get its derivatives by these, nv x nv, row by
/// row.
void differenceOf(const CompactImpl& m, int body, const double* from, const double* to, double* v, double* J_from = nullptr, double* J_to = nullptr);

}  // namespace dyn
