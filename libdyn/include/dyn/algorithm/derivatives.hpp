// SPDX-License-Identifier: BSD-2-Clause
// Analytical derivatives of inverse and forward dynamics, and the inverse of the mass matrix.
#pragma once

#include <dyn/algorithm/rnea.hpp>

namespace dyn {

/// Derivatives of rnea, nv x nv each, in [N m, N] per unit of q (in its tangent space), v, a.
struct RNEADerivatives {
  MatrixResult dtau_dq,  ///< of tau by q
      dtau_dv;           ///< of tau by v
  MatrixResult dtau_da;  ///< M, armature included
};

/// Result of aba and its derivatives, nv x nv each, in [rad/s^2, m/s^2] per unit of q (in its tangent space), v, tau.
struct ABADerivatives {
  VectorResult ddq;       ///< nv accelerations [rad/s^2, m/s^2]
  MatrixResult ddq_dq,    ///< of ddq by q
      ddq_dv;             ///< of ddq by v
  MatrixResult ddq_dtau;  ///< M^-1
};

namespace detail {
struct DerivativeViews {
  const double *ddq, *by_q, *by_v, *inertia;
};
DYN_API DerivativeViews rneaDerivatives(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a, const Force<double>* fext,
                                        std::size_t count);
DYN_API DerivativeViews abaDerivatives(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau, const Force<double>* fext,
                                       std::size_t count);
DYN_API const double* minverse(const CompactModel&, Data&, VectorView q);

inline RNEADerivatives rneaDerivatives(const CompactModel& model, Data& data, const VectorView& q, const VectorView& v, const VectorView& a,
                                       const Force<double>* fext, std::size_t count) {
  const DerivativeViews x = rneaDerivatives(model, data, q, &v, &a, fext, count);
  const int n = model.nv();
  return {{x.by_q, n, n}, {x.by_v, n, n}, {x.inertia, n, n}};
}
inline ABADerivatives abaDerivativesOf(const CompactModel& model, const DerivativeViews& x) {
  const int n = model.nv();
  return {{x.ddq, n}, {x.by_q, n, n}, {x.by_v, n, n}, {x.inertia, n, n}};
}
}  // namespace detail

/// Computes the derivatives of rnea(q, v, a) for every joint type, dissipation included (except the jump of friction at v = 0). O(n depth). Singh,
/// Russell and Wensing 2022, in the axes of the floating base, or the world, with the origin at each joint. Positions and velocities are relative to
/// the joints' origins, so a base that is far away or fast costs no accuracy. Column k of a derivative by q is the change along
/// integrate(q, eps e_k). Where a motion subspace varies with q, the joint type's own code is differentiated. Needs Need::derivatives. Throws
/// Error(size | argument).
inline RNEADerivatives computeRNEADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return detail::rneaDerivatives(model, data, q, v, a, nullptr, 0);
}
/// Computes the same with external forces. Each force turns with the body on which it acts.
inline RNEADerivatives computeRNEADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                                              const ExternalForces& fext) {
  return detail::rneaDerivatives(model, data, q, v, a, fext.data(), fext.size());
}

/// Computes dg/dq of generalizedGravity, nv x nv. O(n depth). Needs Need::derivatives. Throws Error(size | argument).
inline MatrixResult computeGeneralizedGravityDerivatives(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::rneaDerivatives(model, data, q, nullptr, nullptr, nullptr, 0).by_q, model.nv(), model.nv()};
}

/// Computes the derivatives of aba(q, v, tau) by differentiating the articulated-body recursion, so the condition of M costs no digits. O(n^2).
/// A model with dependent joints goes through M^-1 instead, O(n^3). Needs Need::derivatives.
/// Throws Error(size | argument), and Error(singular), which names the joint, where M is singular.
inline ABADerivatives computeABADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau) {
  return detail::abaDerivativesOf(model, detail::abaDerivatives(model, data, q, v, tau, nullptr, 0));
}
/// Computes the same with external forces. Each force turns with the body on which it acts.
inline ABADerivatives computeABADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            const ExternalForces& fext) {
  return detail::abaDerivativesOf(model, detail::abaDerivatives(model, data, q, v, tau, fext.data(), fext.size()));
}

/// Computes M^-1(q), nv x nv, symmetric to the last bit. It is the product of tree-sparse factors that are read off articulated inertias,
/// O(n^2 depth). A model with dependent joints factors the M of crba instead, O(n^3). Needs Need::derivatives.
/// Throws Error(size | argument), and Error(singular), which names the joint, where M is singular.
inline MatrixResult computeMinverse(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::minverse(model, data, q), model.nv(), model.nv()};
}

}  // namespace dyn
