// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of the rows' accelerations, and of the generalised force of given row forces.
#pragma once

#include "algorithm/support/inputs.hpp"
#include "constraint/constraint_data.hpp"

namespace dyn {

/// Writes the derivatives of the rows' accelerations, with the feedback of their errors if `feedback`, and of the generalised force of c.lambda. The
/// rows have been located at this state, and forceDerivatives has just run at it.
void linearizeRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const Inputs& x, bool feedback, const kernels::RowDerivatives& out);

/// Writes the external forces on the joints' bodies, by the user's numbers, that equal the forces c.lambda of the rows as they were located last.
/// Constraints on joints contribute none.
void rowForcesOnBodies(const CompactModel& model, const ConstraintDataImpl& c, Force<double>* fext);

}  // namespace dyn
