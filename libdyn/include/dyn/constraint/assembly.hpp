// SPDX-License-Identifier: BSD-2-Clause
// Projection of configurations and velocities onto constraints.
#pragma once

#include <dyn/constraint/dynamics.hpp>

namespace dyn {

/// How projectConfiguration and assemble iterate.
struct AssemblySettings {
  double tolerance = 1e-10;  ///< [m, rad] largest error of a row that counts as closed
  int max_iterations = 100;  ///< limit of Newton steps
};

/// Result of projectConfiguration.
struct Assembly {
  VectorResult q;  ///< nq
  double error;    ///< largest error of a row [m, rad]; infinity if one is NaN
  bool closed;     ///< error <= tolerance
  int iterations;  ///< Newton steps taken
};

namespace detail {
struct AssemblyViews {
  const double* q;
  double error;
  bool closed;
  int iterations;
};
DYN_API AssemblyViews projectConfiguration(const CompactModel&, Data&, VectorView q, ConstraintData&, const AssemblySettings&);
DYN_API void assemble(const CompactModel&, Data&, const VectorOut& q, ConstraintData&, const AssemblySettings&);
}  // namespace detail

/// Moves q to a configuration where the frames of constraints with a target coincide, and couplings and locks hold. Takes Newton steps in the
/// tangent space, the shortest in the metric of the kinetic energy, and halves a step that would increase the error. Iteration stops when no step
/// reduces the error. Rows without a target (contacts) do not move to first order. Does not throw if q does not close: see `closed`.
/// O(n + rows^3) a step. Needs Need::mass_matrix for a model with dependent joints. Throws Error(size | argument | singular).
inline Assembly projectConfiguration(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints,
                                     const AssemblySettings& settings = {}) {
  const detail::AssemblyViews x = detail::projectConfiguration(model, data, q, constraints, settings);
  return {{x.q, model.nq()}, x.error, x.closed, x.iterations};
}

/// Replaces the guess q by a closed configuration. If the guess leads to none, throws Error(closure), which names the remaining error and its
/// constraint, and leaves q unchanged.
inline void assemble(const CompactModel& model, Data& data, const VectorOut& q, ConstraintData& constraints, const AssemblySettings& settings = {}) {
  detail::assemble(model, data, q, constraints, settings);
}

/// Returns the velocity with J v = 0 that is nearest to v in the metric of the kinetic energy: the velocity after an impact without restitution.
/// Costs and throws as impulseDynamics.
inline VectorResult projectVelocity(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, ConstraintData& constraints) {
  return impulseDynamics(model, data, q, v, 0.0, constraints).v_after;
}

}  // namespace dyn
