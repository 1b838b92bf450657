// SPDX-License-Identifier: BSD-2-Clause
// Analytical derivatives of constrained dynamics.
#pragma once

#include <dyn/constraint/dynamics.hpp>

namespace dyn {

/// Results and derivatives of constraintDynamics. Derivatives by q are in its tangent space. With redundant rows the derivatives are those of the
/// least-norm forces, for changes that keep the rank.
struct ConstraintDynamicsDerivatives {
  VectorResult ddq,        ///< accelerations, nv
      lambda;              ///< forces of the rows, as in ConstrainedMotion
  MatrixResult ddq_dq,     ///< of ddq by q, nv x nv
      ddq_dv,              ///< of ddq by v, nv x nv
      ddq_dtau;            ///< of ddq by tau, nv x nv
  MatrixResult lambda_dq,  ///< of lambda by q, rows x nv
      lambda_dv,           ///< of lambda by v, rows x nv
      lambda_dtau;         ///< of lambda by tau, rows x nv
};

/// Results and derivatives of impulseDynamics by q, in its tangent space, and by v, the velocity before the impact.
struct ImpulseDynamicsDerivatives {
  VectorResult v_after,     ///< velocities, nv
      impulse;              ///< impulses of the rows, as in ConstrainedImpact
  MatrixResult v_after_dq,  ///< of v_after by q, nv x nv
      v_after_dv;           ///< of v_after by v, nv x nv
  MatrixResult impulse_dq,  ///< of impulse by q, rows x nv
      impulse_dv;           ///< of impulse by v, rows x nv
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

/// Computes the derivatives of impulseDynamics in the same way, with the same needs. Throws as impulseDynamics.
inline ImpulseDynamicsDerivatives computeImpulseDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                                    double restitution, ConstraintData& constraints) {
  const detail::ConstrainedDerivativeViews x = detail::impulseDynamicsDerivatives(model, data, q, v, restitution, constraints);
  const int n = model.nv(), r = constraints.set().rows();
  return {{x.motion, n}, {x.lambda, r}, {x.motion_dq, n, n}, {x.motion_dv, n, n}, {x.lambda_dq, r, n}, {x.lambda_dv, r, n}};
}

}  // namespace dyn
