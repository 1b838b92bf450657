// SPDX-License-Identifier: BSD-2-Clause
// Forward dynamics by the articulated-body algorithm.
#pragma once

#include <dyn/algorithm/rnea.hpp>

namespace dyn {

namespace detail {
DYN_API const double* aba(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau, const Force<double>* fext, std::size_t count);
}

/// Computes the joint accelerations ddq = M^-1 (tau - C v - g - dissipation) [rad/s^2, m/s^2]. q: nq; v, tau: nv; result: nv. O(n).
/// A model with dependent joints factors M instead, O(n^3), and needs Need::mass_matrix. Featherstone 2008, table 7.1, in the axes of the floating
/// base, or the world, with the origin at each joint. Throws Error(size | argument), and Error(singular), which names the joint, where M is singular.
inline VectorResult aba(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau) {
  return {detail::aba(model, data, q, v, tau, nullptr, 0), model.nv()};
}
/// Computes the same with the external forces added to tau as sum J^T fext.
inline VectorResult aba(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau,
                        const ExternalForces& fext) {
  return {detail::aba(model, data, q, v, tau, fext.data(), fext.size()), model.nv()};
}

}  // namespace dyn
