// Configurations and velocities brought onto what constraints allow.
#pragma once

#include <dyn/constraint/dynamics.hpp>

namespace dyn {

struct AssemblySettings {
  double tolerance = 1e-10;  ///< [m, rad] of each row's error
  int max_iterations = 100;
};

struct Assembly {
  VectorResult q;  ///< nq
  double error;    ///< largest error of a row [m, rad]
  bool closed;     ///< error <= tolerance
  int iterations;
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

/// q moved to where the frames of constraints with a target coincide, couplings and locks hold: Newton steps in the tangent space, the
/// shortest in the metric of the kinetic energy, halved where the error would grow, to the last digit that they win. Rows without a target
/// (contacts) are not moved to first order. No exception if it does not close: see `closed`. O(n + rows^3) a step.
inline Assembly projectConfiguration(const CompactModel& model, Data& data, const VectorArg& q, ConstraintData& constraints,
                                     const AssemblySettings& settings = {}) {
  const detail::AssemblyViews x = detail::projectConfiguration(model, data, q, constraints, settings);
  return {{x.q, model.nq()}, x.error, x.closed, x.iterations};
}

/// The same in place of a guess, q. Throws Error(closure) with the error that is left and the constraint that it is in if the guess leads to
/// no closed configuration; q is then as it was.
inline void assemble(const CompactModel& model, Data& data, const VectorOut& q, ConstraintData& constraints, const AssemblySettings& settings = {}) {
  detail::assemble(model, data, q, constraints, settings);
}

/// The velocity nearest to v, in the metric of the kinetic energy, that the constraints allow: that after an impact without restitution.
inline VectorResult projectVelocity(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, ConstraintData& constraints) {
  return impulseDynamics(model, data, q, v, 0.0, constraints).v_after;
}

}  // namespace dyn
