// Inverse dynamics by the recursive Newton-Euler algorithm.
#pragma once

#include <dyn/data/data.hpp>

#include <vector>

namespace dyn {

/// External forces: one for each joint, the universe included; each acts on the joint's body, in the joint's own frame [N, N m].
using ExternalForces = std::vector<Force<double>>;

namespace detail {
DYN_API const double* rnea(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a, const Force<double>* fext, std::size_t count);
DYN_API const double* nonLinearEffects(const CompactModel&, Data&, VectorView q, VectorView v);
DYN_API const double* generalizedGravity(const CompactModel&, Data&, VectorView q);
}  // namespace detail

/// tau [N m, N] = M(q) a + C(q, v) v + g(q), plus damping and friction of the joints. q: nq; v, a: nv; result: nv. O(n).
/// Newton's and Euler's equations with classical accelerations in body axes (Luh, Walker, Paul 1980): linear velocities never enter, so
/// the result does not depend on how fast a base moves. Throws Error(size | argument).
inline VectorResult rnea(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return {detail::rnea(model, data, q, v, a, nullptr, 0), model.nv()};
}
/// The same less the generalised external forces sum J^T f.
inline VectorResult rnea(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                         const ExternalForces& fext) {
  return {detail::rnea(model, data, q, v, a, fext.data(), fext.size()), model.nv()};
}
/// C(q, v) v + g(q), with losses: rnea at a = 0. O(n).
inline VectorResult nonLinearEffects(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  return {detail::nonLinearEffects(model, data, q, v), model.nv()};
}
/// g(q): rnea at rest. O(n).
inline VectorResult generalizedGravity(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::generalizedGravity(model, data, q), model.nv()};
}

}  // namespace dyn
