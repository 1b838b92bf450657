// SPDX-License-Identifier: BSD-2-Clause
// Joint forces that do not come from the bodies' inertia: armature, damping and friction, in expanded coordinates.
#pragma once

#include "compile/compact_impl.hpp"

#include <dyn/scalar/select.hpp>

namespace dyn::kernels {

/// Adds sign * (damping v + friction sign(v)) to tau.
template <class S>
void addDissipation(const CompactImpl& m, double sign, const S* v, S* tau) {
  for (std::size_t k = 0; k < m.damping.size(); ++k) tau[k] += S(static_cast<Real<S>>(sign * m.damping[k])) * v[k];
  for (std::size_t k = 0; k < m.friction.size(); ++k) {
    const S f(static_cast<Real<S>>(sign * m.friction[k]));
    tau[k] += select(v[k] > S(0), f, select(v[k] < S(0), -f, S(0)));
  }
}

/// Adds armature * a, damping and friction to tau, the forces that move the bodies.
template <class S>
void addJointForces(const CompactImpl& m, const S* v, const S* a, S* tau) {
  for (std::size_t k = 0; k < m.armature.size(); ++k) tau[k] += S(static_cast<Real<S>>(m.armature[k])) * a[k];
  addDissipation(m, 1.0, v, tau);
}

}  // namespace dyn::kernels
