// Derivatives of the rows' accelerations, and of the generalised force of given row forces.
#pragma once

#include "algorithm/inputs.hpp"
#include "constraint/constraint_data.hpp"

namespace dyn {

/// Of the rows' accelerations, with what they feed back of their errors or without, at a state at which they were located and
/// which forceDerivatives has just been asked at; and of the forces c.lambda.
void linearizeRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const Inputs& x, bool feedback, const kernels::RowDerivatives& out);

/// External forces on joints' bodies, as the user numbers them, that forces of the rows amount to where the rows were located
/// last. Constraints on joints have none.
void rowForcesOnBodies(const CompactModel& model, const ConstraintDataImpl& c, Force<double>* fext);

}  // namespace dyn
