// SPDX-License-Identifier: BSD-2-Clause
// Dynamics of a model under constraints: accelerations and constraint forces, impacts, and the motion and Jacobian of the rows.
//
// lambda is the force [N, N m] that the world, or the other body, exerts on a constraint's frame, in the constraint's axes at its origin; for
// couplings and locks it is the generalised force on the joint. The functions take all memory from Data and ConstraintData and do not allocate.
// They throw Error(argument | size) for wrong arguments, and Error(singular), naming the joint, where M is singular.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// articulated: the articulated-body recursion propagates the constraints' forces too. It is linear in the number of bodies and never forms M.
/// kkt: computes M by crba, factors with the tree's sparsity, and J. Models with dependent joints always use this method.
enum class ConstraintMethod { articulated, kkt };

struct ConstrainedMotion {
  VectorResult ddq;     ///< nv
  VectorResult lambda;  ///< rows
  double residual;      ///< largest violation of a row's acceleration: only rounding, unless constraints contradict each other
  int rank;             ///< of the rows; if some are redundant it is less than their number, and lambda has least norm
  int iterations;       ///< of the solver for lambda
};

struct ConstrainedImpact {
  VectorResult v_after;  ///< nv
  VectorResult impulse;  ///< rows [N s, N m s]
  double residual;       ///< largest violation of a row's velocity
  int rank;
};

struct ConstraintMotion {
  VectorResult velocity;  ///< J v
  VectorResult bias;      ///< gamma: acceleration of the rows at ddq = 0, without gravity
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
/// Popov and Vereshchagin 1978; Featherstone 2008, ch. 8.
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, nullptr, 0);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}
/// The same with external forces, as rnea takes them.
inline ConstrainedMotion constraintDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            ConstraintData& constraints, const ExternalForces& fext,
                                            ConstraintMethod method = ConstraintMethod::articulated) {
  const detail::ConstrainedViews x = detail::constraintDynamics(model, data, q, v, tau, constraints, method, fext.data(), fext.size());
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank, x.iterations};
}

/// Solves M (v_after - v) = J^T impulse with J v_after = -restitution * J v for v_after and impulse; restitution is in [0, 1]. O(n + rows^3).
/// Featherstone 2008, sec. 11.7.
inline ConstrainedImpact impulseDynamics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, double restitution,
                                         ConstraintData& constraints) {
  const detail::ConstrainedViews x = detail::impulseDynamics(model, data, q, v, restitution, constraints);
  return {{x.motion, model.nv()}, {x.lambda, constraints.set().rows()}, x.residual, x.rank};
}

/// Computes velocities, biases and errors of the rows. The acceleration of a row is that of the point for contacts that hold a point, and the
/// derivative of J v in the constraint's axes for all other constraints. O(n).
inline ConstraintMotion computeConstraintMotion(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                ConstraintData& constraints) {
  const detail::ConstraintMotionViews x = detail::constraintMotion(model, data, q, v, constraints);
  const int n = constraints.set().rows();
  return {{x.velocity, n}, {x.bias, n}, {x.error, n}};
}

/// Computes J, rows x nv: J v is the velocity of the rows. O(n + b rows) for b bodies between constraints and the world.
inline MatrixResult computeConstraintJacobian(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints) {
  return {detail::constraintJacobian(model, data, q, constraints), constraints.set().rows(), model.nv()};
}

}  // namespace dyn
