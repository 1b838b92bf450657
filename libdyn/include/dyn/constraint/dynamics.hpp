// Dynamics of a model under constraints: accelerations and forces, impacts, and the quantities that they are made of.
//
// lambda: what the world, or the other body, does to the frame that a constraint is on, [N, N m] in the constraint's axes at its origin; for
// couplings and locks the generalised force on the joint. All take their memory from Data and ConstraintData, and neither allocate nor throw
// once arguments are right, but for Error(singular) naming the joint where M is singular, and Error(argument | size).
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// articulated: the articulated-body recursion carries the constraints' forces along, linear in the number of bodies, and M is never formed.
/// kkt: M by crba, its factors that follow the tree, J. A model with joints that follow others is always solved this way.
enum class ConstraintMethod { articulated, kkt };

struct ConstrainedMotion {
  VectorResult ddq;     ///< nv
  VectorResult lambda;  ///< rows
  double residual;      ///< largest violation of the rows' accelerations, as bodies move: rounding, unless constraints contradict each other
  int rank;             ///< of the rows; less than their number where some imply others. Forces are those of least norm then
  int iterations;       ///< of the solution for lambda
};

struct ConstrainedImpact {
  VectorResult v_after;  ///< nv
  VectorResult impulse;  ///< rows [N s, N m s]
  double residual;       ///< as above, of velocities
  int rank;
};

struct ConstraintMotion {
  VectorResult velocity;  ///< J v
  VectorResult bias;      ///< gamma: acceleration of the rows at ddq = 0, without gravity
  VectorResult error;     ///< of position, of constraints with a target: where the frame is less where it should be; rotation vectors
};

namespace detail {
struct ConstrainedViews {
  const double *motion, *lambda;
  double residual;
  int rank, iterations;
};
DYN_API ConstrainedViews constraintDynamics(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau, ConstraintData&, ConstraintMethod,
                                            const Force<double>* fext, std::size_t count);
DYN_API ConstrainedViews impulseDynamics(const CompactModel&, Data&, VectorView q, VectorView v, double restitution, ConstraintData&);
struct ConstraintMotionViews {
  const double *velocity, *bias, *error;
};
DYN_API ConstraintMotionViews constraintMotion(const CompactModel&, Data&, VectorView q, VectorView v, ConstraintData&);
DYN_API const double* constraintJacobian(const CompactModel&, Data&, VectorView q, ConstraintData&);
}  // namespace detail

/// M ddq + C v + g = tau + J^T lambda with J ddq + gamma = -velocity gain * J v - position gain * error. O(n + rows^3).
/// Where rows imply each other the forces are those of least norm, where they contradict each other the accelerations those of least squares.
/// Popov and Vereshchagin 1978; Featherstone 2008, ch. 8.
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, nullptr, 0);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, const ExternalForces& fext,
                                            ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, fext.data(), fext.size());
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}

/// M (v_after - v) = J^T impulse with J v_after = -restitution * J v, restitution in [0, 1]. O(n + rows^3). Featherstone 2008, sec. 11.7.
inline ConstrainedImpact impulseDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, double restitution,
                                         ConstraintData& constraints) {
  const detail::ConstrainedViews x = detail::impulseDynamics(model, data, q, v, restitution, constraints);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank};
}

/// Velocities, biases and errors of the rows. Contacts that hold a point take the acceleration of that point; all others the derivative of
/// J v in the constraint's axes. O(n).
inline ConstraintMotion computeConstraintMotion(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                ConstraintData& constraints) {
  const detail::ConstraintMotionViews x = detail::constraintMotion(model, data, q, v, constraints);
  const int n = constraints.set().rows();
  return {{x.velocity, n}, {x.bias, n}, {x.error, n}};
}

/// J, rows x nv: J v is the velocity of the rows. O(n + bodies between constraints and the world x rows).
inline MatrixResult computeConstraintJacobian(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  return {detail::constraintJacobian(model, data, q, constraints), constraints.set().rows(), model.nv()};
}

}  // namespace dyn
