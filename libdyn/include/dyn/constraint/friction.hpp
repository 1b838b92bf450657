// SPDX-License-Identifier: BSD-2-Clause
// Contacts with friction, limits of joints and joint friction: forces within Coulomb's cone or below a largest force.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// Limits the force of one constraint of a set. The constraint is
///   - a contact, whose rows are the three translations (x, y, z in its axes), with z along the normal, away from the other body; or
///   - the lock of a joint of one degree of freedom, which becomes a limit that pushes its coordinate one way; or
///   - a lock of which one coordinate becomes the joint's own friction, which holds both ways up to its largest force.
/// Rows of the set that no cone names hold both ways with any force.
struct FrictionCone {
  int constraint = 0;  ///< its number in the set
  /// Coefficient: the tangential force is at most friction * normal force. Not negative, 0 for limits. For joint friction the largest force [N, N m].
  double friction = 0;
  double gap = 0;          ///< [m, rad] that contactStep may close: the normal velocity after is at least -gap / dt. The step undoes a negative gap
  bool downwards = false;  ///< for a limit: it is an upper limit, which pushes the coordinate down
  bool both_ways = false;  ///< for a lock: it is the joint's own friction
  int coordinate = 0;      ///< for joint friction: which of the joint's degrees of freedom
};

/// How contactStep and contactForces iterate.
struct ContactSettings {
  /// [m/s; in contactForces m/s^2] Largest error of velocities, and of changes of impulses times the largest row sum of the Delassus matrix.
  double tolerance = 1e-9;
  int max_iterations = 2000;  ///< limit of iterations, after which the last forces are returned
  double restitution = 0;     ///< of approaching normal velocities where the gap is closed, in [0, 1]
};

/// How well the conditions are satisfied. Each force is exactly within its cone. Normal velocities count from the bound that gap and restitution set.
struct ContactResidual {
  double penetration;      ///< [m/s] largest normal velocity into the other body, or velocity of a row that no cone names
  double complementarity;  ///< [J] largest |impulse . (velocity + friction |slip| normal)| of a contact: normal and dissipation conditions at once
};

/// Result of contactStep.
struct ContactStep {
  VectorResult v_after;      ///< nv velocities [rad/s, m/s]
  VectorResult impulse;      ///< of the rows [N s, N m s]
  VectorResult velocity;     ///< of the rows [m/s, rad/s], after the step, as contactStep constrains them
  ContactResidual residual;  ///< of the returned impulses
  bool converged;            ///< the tolerance was reached
  int iterations;            ///< of the solver; 0 if all contacts hold
};

/// Result of contactForces.
struct ContactForces {
  VectorResult lambda;  ///< of the rows [N, N m]
  VectorResult left;    ///< nv: generalised force [N m, N] that lambda cannot explain
  bool converged;       ///< the tolerance was reached
  int iterations;       ///< of the solver
};

/// Describes a point contact: `point`, in the axes of `frame`, touches the body of `other`. `normal` is that of the other's surface, in the axes of
/// `other`, of any length. Throws Error(argument) for a normal without direction.
DYN_API ConstraintDescription frictionContact(const std::string& name, const std::string& frame, const Vec3<double>& point,
                                              const Vec3<double>& normal, const std::string& other = "universe");

namespace detail {
struct ContactViews {
  const double *motion, *force, *velocity;
  ContactResidual residual;
  bool converged;
  int iterations;
};
DYN_API ContactViews contactStep(const CompactModel&, Data&, VectorView q, VectorView v, VectorView tau, double dt, ConstraintData&,
                                 const FrictionCone* cones, std::size_t count, const ContactSettings&);
DYN_API ContactViews contactForces(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a, VectorView tau, ConstraintData&,
                                   const FrictionCone* cones, std::size_t count, const ContactSettings&);
}  // namespace detail

/// Takes one time step at the level of velocities, with q held: M (v_after - v) = dt (tau - C v - g) + J^T impulse. Normal impulses are >= 0, normal
/// velocities are >= -gap / dt - restitution * before, and one of the two is at its bound (Signorini). Friction opposes slip at the edge of its cone
/// (Coulomb; the exact cone, not a pyramid). Contacts and limits constrain J(q) (v_after + dt w x v), with the axes of free and planar joints held
/// as at q: this is the velocity of the contact's location. Material points rotate away from it when a body rolls. Rows that no cone names keep
/// J v = 0 along the motion, dJ/dt v included. If all contacts hold, the factors of the Delassus matrix give the solution without iterations.
/// Otherwise the alternating direction method with de Saxce's correction finds it (Carpentier, Le Lidec, Montaut 2024). Forces need not be unique.
/// O(n + rows^3 + iterations rows^2). Throws Error(argument | size | singular), but not if it does not converge: see `converged` and the residual.
/// Needs Need::mass_matrix for a model with dependent joints, as contactForces does.
inline ContactStep contactStep(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau, double dt,
                               ConstraintData& constraints, const std::vector<FrictionCone>& cones, const ContactSettings& settings = {}) {
  const detail::ContactViews x = detail::contactStep(model, data, q, v, tau, dt, constraints, cones.data(), cones.size(), settings);
  const int rows = constraints.set().rows();
  return {{x.motion, model.nv()}, {x.force, rows}, {x.velocity, rows}, x.residual, x.converged, x.iterations};
}

/// Finds the forces within their cones that best explain the acceleration a under tau: J^T lambda is nearest to M a + C v + g - tau in the metric of
/// M^-1. Gaps and restitution have no influence. Throws as contactStep.
inline ContactForces contactForces(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                                   const VectorArg& tau, ConstraintData& constraints, const std::vector<FrictionCone>& cones,
                                   const ContactSettings& settings = {}) {
  const detail::ContactViews x = detail::contactForces(model, data, q, v, a, tau, constraints, cones.data(), cones.size(), settings);
  return {{x.force, constraints.set().rows()}, {x.motion, model.nv()}, x.converged, x.iterations};
}

}  // namespace dyn
