// SPDX-License-Identifier: BSD-2-Clause
// Inverse dynamics by the recursive Newton-Euler algorithm.
#pragma once

#include <dyn/data/data.hpp>

#include <vector>

namespace dyn {

/// External forces [N, N m], one for each joint; the one at 0, for the world, is ignored. Each acts on the joint's body and is given in the
/// joint's own frame. An empty vector means no forces. Functions throw Error(size) for any other number of entries than njoints.
using ExternalForces = std::vector<Force<double>>;

namespace detail {
DYN_API const double* rnea(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a, const Force<double>* fext, std::size_t count);
DYN_API const double* nonLinearEffects(const CompactModel&, Data&, VectorView q, VectorView v);
DYN_API const double* generalizedGravity(const CompactModel&, Data&, VectorView q);
DYN_API const double* staticTorque(const CompactModel&, Data&, VectorView q, const Force<double>* fext, std::size_t count);
}  // namespace detail

/// Computes the joint forces tau = M(q) a + C(q, v) v + g(q) [N m, N], plus damping and friction of the joints. q: nq; v, a: nv; result: nv. O(n).
/// Uses Newton's and Euler's equations with classical accelerations in body axes (Luh, Walker, Paul 1980). The bodies' linear velocities are not
/// needed, so a fast base costs no accuracy. Throws Error(size | argument).
inline VectorResult rnea(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return {detail::rnea(model, data, q, v, a, nullptr, 0), model.nv()};
}
/// Computes the same, less the generalised external forces sum J^T fext.
inline VectorResult rnea(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                         const ExternalForces& fext) {
  return {detail::rnea(model, data, q, v, a, fext.data(), fext.size()), model.nv()};
}
/// Computes C(q, v) v + g(q) [N m, N], nv entries, dissipation included: rnea at a = 0. O(n). Throws Error(size | argument).
inline VectorResult nonLinearEffects(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  return {detail::nonLinearEffects(model, data, q, v), model.nv()};
}
/// Computes g(q) [N m, N], nv entries: rnea at rest (v = a = 0). O(n). Throws Error(size | argument).
inline VectorResult generalizedGravity(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::generalizedGravity(model, data, q), model.nv()};
}
/// Computes the joint forces that hold the robot still at q against gravity and the external forces: tau = g(q) - sum J^T fext [N m, N]. q: nq;
/// result: nv. O(n). Throws Error(size | argument).
inline VectorResult computeStaticTorque(const CompactModel& model, Data& data, const VectorArg& q, const ExternalForces& fext) {
  return {detail::staticTorque(model, data, q, fext.data(), fext.size()), model.nv()};
}

}  // namespace dyn
