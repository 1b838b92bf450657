// Derivatives of the rows' velocities and accelerations, and of the generalised force of given row forces.
#pragma once

#include "constraint/constraint_data.hpp"

namespace dyn {

/// What is differentiated: accelerations with their feedback, or velocities.
enum class RowQuantity { acceleration, velocity };

/// Where derivatives go: rows x nv each, column-major, the last one the Jacobian; and nv x nv, to which what the turning of forces' axes and the
/// moving of their points changes is added, with the sign of the equations of motion, M a + h - J^T lambda. by_v may be null.
struct RowDerivatives {
  double *by_q, *by_v, *J, *force_by_q;
};

/// After rows were located at q (expanded), and forwardKinematicsDerivatives at q, v and a; for the forces c.lambda.
void linearizeRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, const double* q, RowQuantity quantity, const RowDerivatives& out);

/// External forces on joints' bodies, as the user numbers them, that forces of the rows amount to where the rows were located
/// last. Constraints on joints have none.
void rowForcesOnBodies(const CompactModel& model, const DataImpl& d, const ConstraintDataImpl& c, Force<double>* fext);

}  // namespace dyn
