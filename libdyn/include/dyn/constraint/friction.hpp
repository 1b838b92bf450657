// Contacts with friction and limits of joints: forces that only push, within Coulomb's cone.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>

namespace dyn {

/// Of a set's constraint, either a contact whose rows are the three translations (x, y, z in its axes), with z along the normal, away from the
/// other body; or the lock of a joint of one degree of freedom, which is then a limit that pushes its coordinate one way; or one coordinate of a
/// lock, which is then the joint's own friction: it holds both ways, as well as its largest force can.
/// Rows of the set that no cone names hold both ways whatever it takes.
struct FrictionCone {
  int constraint = 0;
  /// Coefficient: tangential force at most friction * normal force; not negative, 0 for limits. Of a joint's own friction the largest force [N, N m].
  double friction = 0;
  double gap = 0;  ///< [m, rad] that contactStep may still close: the velocity after is at least -gap / dt; negative: where it is to be undone
  bool downwards = false;  ///< of a limit: it pushes the coordinate down, an upper one
  bool both_ways = false;  ///< of a lock: a joint's own friction
  int coordinate = 0;      ///< of that: which of the joint's degrees of freedom
};

struct ContactSettings {
  double tolerance = 1e-9;  ///< [m/s] for velocities, and with the Delassus matrix' mean for impulses
  int max_iterations = 2000;
  double restitution = 0;  ///< of normal velocities that approach where the gap is closed, in [0, 1]
};

/// How well the conditions are kept: the force is in its cone exactly.
struct ContactResidual {
  double penetration;      ///< [m/s] largest normal velocity into the other body, or violation of a row that holds both ways
  double complementarity;  ///< [J] largest |impulse . (velocity + friction |slip| normal)| of a contact: normal and dissipation conditions at once
};

struct ContactStep {
  VectorResult v_after;   ///< nv
  VectorResult impulse;   ///< rows [N s]
  VectorResult velocity;  ///< rows, after, as contactStep constrains them [m/s]
  ContactResidual residual;
  bool converged;
  int iterations;
};

struct ContactForces {
  VectorResult lambda;  ///< rows [N, N m]
  VectorResult left;    ///< nv: generalised force that they cannot explain
  bool converged;
  int iterations;
};

/// A point contact of `frame`, at `point` in its axes, with the other body, whose surface there has this normal, in the axes of `other`.
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

/// One step of time at the level of velocities, q held: M (v_after - v) = dt (tau - C v - g) + J^T impulse with 0 <= normal impulse, normal
/// velocity >= -gap / dt - restitution * before, one of the two zero, and friction that opposes slip at the edge of its cone (Signorini, Coulomb; the
/// cone itself, not a pyramid). Velocities of contacts and limits are J(q) (v_after + dt w x v), the axes of joints that fly held with q: those of
/// the places where bodies touch, not of the material points, which turn away as bodies roll. Rows that no cone names keep J v = 0 along the motion,
/// dJ/dt v included. Where all contacts hold, by the Delassus matrix' factors, without iterations; else by the alternating direction
/// method with de Saxce's correction (Carpentier, Le Lidec, Montaut 2024). Sets whose forces are not determined are as good as others. Nothing is
/// thrown where it does not converge: see `converged` and the residual. O(n + rows^3 + iterations rows^2). Throws Error(argument | size | singular).
inline ContactStep contactStep(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& tau, double dt,
                               ConstraintData& constraints, const std::vector<FrictionCone>& cones, const ContactSettings& settings = {}) {
  const detail::ContactViews x = detail::contactStep(model, data, q, v, tau, dt, constraints, cones.data(), cones.size(), settings);
  const int rows = constraints.set().rows();
  return {{x.motion, model.nv()}, {x.force, rows}, {x.velocity, rows}, x.residual, x.converged, x.iterations};
}

/// Forces within their cones that explain the acceleration a under tau best: J^T lambda nearest to M a + C v + g - tau, in the metric of M^-1.
inline ContactForces contactForces(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a,
                                   const VectorArg& tau, ConstraintData& constraints, const std::vector<FrictionCone>& cones,
                                   const ContactSettings& settings = {}) {
  const detail::ContactViews x = detail::contactForces(model, data, q, v, a, tau, constraints, cones.data(), cones.size(), settings);
  return {{x.force, constraints.set().rows()}, {x.motion, model.nv()}, x.converged, x.iterations};
}

}  // namespace dyn
