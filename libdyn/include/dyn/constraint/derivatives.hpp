// SPDX-License-Identifier: BSD-2-Clause
// Analytical derivatives of constrained dynamics.
#pragma once

#include <dyn/constraint/dynamics.hpp>

namespace dyn {

/// Derivatives of constraintDynamics: of ddq nv x nv, of lambda rows x nv; those w.r.t. q are in its tangent space. With redundant rows they are
/// derivatives of the least-norm forces for changes that keep the rank.
struct ConstraintDynamicsDerivatives {
  VectorResult ddq, lambda;
  MatrixResult ddq_dq, ddq_dv, ddq_dtau;
  MatrixResult lambda_dq, lambda_dv, lambda_dtau;
};

/// Derivatives of impulseDynamics w.r.t. q and the velocity before the impact, with the same shapes.
struct ImpulseDynamicsDerivatives {
  VectorResult v_after, impulse;
  MatrixResult v_after_dq, v_after_dv;
  MatrixResult impulse_dq, impulse_dv;
};

namespace detail {
struct ConstrainedDerivativeViews {
  const double *motion, *lambda;
  const double *motion_dq, *motion_dv, *motion_dtau;
  const double *lambda_dq, *lambda_dv, *lambda_dtau;
};
DYN_API ConstrainedDerivativeViews constraintDynamicsDerivatives(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau,
                                                                 ConstraintData&);
DYN_API ConstrainedDerivativeViews impulseDynamicsDerivatives(const CompactModel&, Data&, VectorView q, VectorView v, double restitution,
                                                              ConstraintData&);
}  // namespace detail

/// Computes the derivatives of constraintDynamics (articulated method) by differentiating the equations of motion and of the rows (Carpentier and
/// Mansard 2018, sec. V). Forces turn with the axes of their constraints, and Baumgarte feedback is included. Data and ConstraintData both need
/// Need::derivatives. `mu` has no influence, since proximal iterations remove its effect. O(n^2 depth + n^2 rows). Throws as constraintDynamics.
inline ConstraintDynamicsDerivatives computeConstraintDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q,
                                                                          const VectorArg& v, const VectorArg& tau, ConstraintData& constraints) {
  const detail::ConstrainedDerivativeViews x = detail::constraintDynamicsDerivatives(model, data, q, v, tau, constraints);
  const int n = model.nv(), r = constraints.set().rows();
  return {{x.motion, n},         {x.lambda, r},       {x.motion_dq, n, n}, {x.motion_dv, n, n},
          {x.motion_dtau, n, n}, {x.lambda_dq, r, n}, {x.lambda_dv, r, n}, {x.lambda_dtau, r, n}};
}

/// Computes the derivatives of impulseDynamics in the same way, with the same needs.
inline ImpulseDynamicsDerivatives computeImpulseDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                                    double restitution, ConstraintData& constraints) {
  const detail::ConstrainedDerivativeViews x = detail::impulseDynamicsDerivatives(model, data, q, v, restitution, constraints);
  const int n = model.nv(), r = constraints.set().rows();
  return {{x.motion, n}, {x.lambda, r}, {x.motion_dq, n, n}, {x.motion_dv, n, n}, {x.lambda_dq, r, n}, {x.lambda_dv, r, n}};
}

}  // namespace dyn
