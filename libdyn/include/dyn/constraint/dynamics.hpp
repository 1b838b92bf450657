// SPDX-License-Identifier: BSD-2-Clause
// Dynamics of a model under constraints: accelerations and constraint forces, impacts, and the motion and Jacobian of the rows.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// How constraintDynamics solves for motion and forces.
enum class ConstraintMethod {
  articulated,  ///< the articulated-body recursion propagates the constraints' forces, too: linear in the number of bodies, never forms M
  /// Computes M by crba, factors with the tree's sparsity, and J. This needs Need::derivatives. Models with dependent joints always use this method,
  /// with dense factors of M, and need Need::mass_matrix only.
  kkt
};

/// Result of constraintDynamics.
struct ConstrainedMotion {
  VectorResult ddq;  ///< nv accelerations [rad/s^2, m/s^2]
  /// Forces of the rows [N, N m]: the world, or the other body, exerts them on the constraint's frame, in the constraint's axes at its origin. For
  /// couplings and locks they are generalised forces on the joint.
  VectorResult lambda;
  double residual;  ///< [m/s^2, rad/s^2] largest violation of a row's acceleration: only rounding, unless constraints contradict each other
  int rank;         ///< of the rows; if some are redundant it is less than their number, and lambda has least norm
  int iterations;   ///< of the solver for lambda
};

/// Result of impulseDynamics.
struct ConstrainedImpact {
  VectorResult v_after;  ///< nv velocities [rad/s, m/s]
  VectorResult impulse;  ///< impulses of the rows [N s, N m s], with the sign and axes of lambda
  double residual;       ///< [m/s, rad/s] largest violation of a row's velocity
  int rank;              ///< of the rows, as in ConstrainedMotion
};

/// Velocities, biases and errors, one number for each row. Result of computeConstraintMotion.
struct ConstraintMotion {
  VectorResult velocity;  ///< J v [m/s, rad/s]
  VectorResult bias;      ///< gamma [m/s^2, rad/s^2]: acceleration of the rows at ddq = 0, without gravity
  VectorResult error;     ///< position error [m, rad]: actual minus wanted, rotations as rotation vectors; 0 for constraints without a target
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

/// Solves M ddq + C v + g = tau + J^T lambda with J ddq + gamma = -velocity gain * J v - position gain * error for ddq and lambda. O(n + rows^3).
/// Redundant rows give the forces of least norm; rows that contradict each other give the accelerations of least squares.
/// Popov and Vereshchagin 1978; Featherstone 2008, ch. 8. This and the functions below do not allocate. Throws Error(size | argument), and
/// Error(singular), which names the joint, where M is singular.
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, nullptr, 0);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}
/// Computes the same with external forces, as rnea takes them.
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, const ExternalForces& fext,
                                            ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, fext.data(), fext.size());
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}

/// Solves M (v_after - v) = J^T impulse with J v_after = -restitution * J v for v_after and impulse; restitution is in [0, 1]. O(n + rows^3).
/// Featherstone 2008, sec. 11.7. A model with dependent joints factors M, O(n^3), and needs Need::mass_matrix. Throws as constraintDynamics.
inline ConstrainedImpact impulseDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, double restitution,
                                         ConstraintData& constraints) {
  const detail::ConstrainedViews x = detail::impulseDynamics(model, data, q, v, restitution, constraints);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank};
}

/// Computes velocities, biases and errors of the rows. The acceleration of a row is that of the point for contacts that hold a point, and the
/// derivative of J v in the constraint's axes for all other constraints. O(n). Throws Error(size | argument).
inline ConstraintMotion computeConstraintMotion(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                ConstraintData& constraints) {
  const detail::ConstraintMotionViews x = detail::constraintMotion(model, data, q, v, constraints);
  const int n = constraints.set().rows();
  return {{x.velocity, n}, {x.bias, n}, {x.error, n}};
}

/// Computes J, rows x nv: J v is the velocity of the rows. O(n + b rows) for b bodies between constraints and the world. Throws
/// Error(size | argument).
inline MatrixResult computeConstraintJacobian(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  return {detail::constraintJacobian(model, data, q, constraints), constraints.set().rows(), model.nv()};
}

}  // namespace dyn
