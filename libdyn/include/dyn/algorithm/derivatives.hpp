// Analytical derivatives of inverse and forward dynamics, and the inverse of the joint-space inertia.
//
// Derivatives with respect to q are in the tangent space: column k is the change along integrate(q, eps e_k). They hold for every joint
// type; the terms of motion subspaces that vary with q come from differentiating the type's own code. All need Need::derivatives.
#pragma once

#include <dyn/algorithm/rnea.hpp>

namespace dyn {

/// Each nv x nv: [N m, N] a unit of q, v, a.
struct RneaDerivatives {
  MatrixResult dtau_dq, dtau_dv;
  MatrixResult dtau_da;  ///< M, armature included
};

/// Each nv x nv: [rad/s^2, m/s^2] a unit of q, v, tau.
struct AbaDerivatives {
  VectorResult ddq;
  MatrixResult ddq_dq, ddq_dv;
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

inline RneaDerivatives rneaDerivatives(const CompactModel& model, Data& data, const VectorView& q, const VectorView& v, const VectorView& a,
                                       const Force<double>* fext, std::size_t count) {
  const DerivativeViews x = rneaDerivatives(model, data, q, &v, &a, fext, count);
  const int n = model.nv();
  return {{x.by_q, n, n}, {x.by_v, n, n}, {x.inertia, n, n}};
}
inline AbaDerivatives abaDerivativesOf(const CompactModel& model, const DerivativeViews& x) {
  const int n = model.nv();
  return {{x.ddq, n}, {x.by_q, n, n}, {x.by_v, n, n}, {x.inertia, n, n}};
}
}  // namespace detail

/// Of rnea(q, v, a), losses included (friction's jump at v = 0 is not). O(n depth). Singh, Russell and Wensing 2022, in the axes of the root
/// body with the origin at each joint; the base's linear velocity and position never enter. Throws Error(size | argument).
inline RneaDerivatives computeRNEADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return detail::rneaDerivatives(model, data, q, v, a, nullptr, 0);
}
/// The same with external forces, which turn with the bodies that they act on.
inline RneaDerivatives computeRNEADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                                              const ExternalForces& fext) {
  return detail::rneaDerivatives(model, data, q, v, a, fext.data(), fext.size());
}

/// dg/dq of generalizedGravity, nv x nv. O(n depth). Throws Error(size | argument).
inline MatrixResult computeGeneralizedGravityDerivatives(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::rneaDerivatives(model, data, q, nullptr, nullptr, nullptr, 0).by_q, model.nv(), model.nv()};
}

/// Of aba(q, v, tau): the articulated-body recursion differentiated, so that the condition of M costs no digits. O(n^2).
/// Throws Error(size | argument), and Error(singular) naming the joint where M is singular.
inline AbaDerivatives computeABADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau) {
  return detail::abaDerivativesOf(model, detail::abaDerivatives(model, data, q, v, tau, nullptr, 0));
}
inline AbaDerivatives computeABADerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                                            const ExternalForces& fext) {
  return detail::abaDerivativesOf(model, detail::abaDerivatives(model, data, q, v, tau, fext.data(), fext.size()));
}

/// M^-1(q), nv x nv, symmetric to the last bit, from the factors of M that follow the tree, read off articulated inertias. O(n^2 depth).
/// Throws Error(size | argument), and Error(singular) naming the joint where M is singular.
inline MatrixResult computeMinverse(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::minverse(model, data, q), model.nv(), model.nv()};
}

}  // namespace dyn
