// Analytical derivatives of constrained dynamics.
#pragma once

#include <dyn/constraint/dynamics.hpp>

namespace dyn {

/// Of accelerations nv x nv, of forces rows x nv; w.r.t. q in its tangent space. Where rows imply each other these are derivatives of the
/// least-norm forces for changes that leave the rank as it is.
struct ConstraintDynamicsDerivatives {
  VectorResult ddq, lambda;
  MatrixResult ddq_dq, ddq_dv, ddq_dtau;
  MatrixResult lambda_dq, lambda_dv, lambda_dtau;
};

/// v_after and impulse likewise, w.r.t. q and the velocity before.
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

/// Of constraintDynamics, by the articulated recursion: the equations of motion and of the rows differentiated (Carpentier and Mansard 2018,
/// sec. V), forces turning with the axes of their constraints. Feedback (Baumgarte) included. Needs Need::derivatives of both Data and
/// ConstraintData. `mu`, whose effect proximal iterations take away, has no part in it. O(n^2 depth + n^2 rows). Throws as
/// constraintDynamics.
inline ConstraintDynamicsDerivatives computeConstraintDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q,
                                                                          const VectorArg& v, const VectorArg& tau, ConstraintData& constraints) {
  const detail::ConstrainedDerivativeViews x = detail::constraintDynamicsDerivatives(model, data, q, v, tau, constraints);
  const int n = model.nv(), r = constraints.set().rows();
  return {{x.motion, n},         {x.lambda, r},       {x.motion_dq, n, n}, {x.motion_dv, n, n},
          {x.motion_dtau, n, n}, {x.lambda_dq, r, n}, {x.lambda_dv, r, n}, {x.lambda_dtau, r, n}};
}

/// Of impulseDynamics. As above.
inline ImpulseDynamicsDerivatives computeImpulseDynamicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v,
                                                                    double restitution, ConstraintData& constraints) {
  const detail::ConstrainedDerivativeViews x = detail::impulseDynamicsDerivatives(model, data, q, v, restitution, constraints);
  const int n = model.nv(), r = constraints.set().rows();
  return {{x.motion, n}, {x.lambda, r}, {x.motion_dq, n, n}, {x.motion_dv, n, n}, {x.lambda_dq, r, n}, {x.lambda_dv, r, n}};
}

}  // namespace dyn
