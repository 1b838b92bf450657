// SPDX-License-Identifier: BSD-2-Clause
// Centre of mass, its motion and Jacobian, and energies.
#pragma once

#include <dyn/data/data.hpp>

namespace dyn {

/// The centre of mass and its motion, in world axes. Velocity and acceleration are zero unless the call computes them.
struct CenterOfMass {
  Vec3<double> position,  ///< [m]
      velocity,           ///< [m/s]
      acceleration;       ///< [m/s^2]; gravity not included
};

namespace detail {
DYN_API CenterOfMass centerOfMass(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a);
DYN_API const double* jacobianCenterOfMass(const CompactModel&, Data&, VectorView q);
DYN_API double kineticEnergy(const CompactModel&, Data&, VectorView q, VectorView v);
DYN_API double potentialEnergy(const CompactModel&, Data&, VectorView q);
}  // namespace detail

/// Computes the centre of mass; with v its velocity, too; with a also its acceleration. Runs forwardKinematics with the same arguments. O(n).
/// Bodies welded to the world do not count. The centre of a model without mass is NaN. Throws Error(size | argument).
/// @{
inline CenterOfMass centerOfMass(const CompactModel& model, Data& data, const VectorArg& q) {
  return detail::centerOfMass(model, data, q, nullptr, nullptr);
}
inline CenterOfMass centerOfMass(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  const VectorView vv = v;
  return detail::centerOfMass(model, data, q, &vv, nullptr);
}
inline CenterOfMass centerOfMass(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  const VectorView vv = v, aa = a;
  return detail::centerOfMass(model, data, q, &vv, &aa);
}
/// @}
/// Computes the Jacobian Jcom, 3 x nv, in world axes: the velocity of the centre of mass is Jcom v. O(n). Throws Error(size | argument).
inline MatrixResult jacobianCenterOfMass(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::jacobianCenterOfMass(model, data, q), 3, model.nv()};
}
/// Computes the kinetic energy v^T M v / 2 [J], armature included. O(n). Throws Error(size | argument).
inline double computeKineticEnergy(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  return detail::kineticEnergy(model, data, q, v);
}
/// Computes the potential energy [J], the sum of -m g . c over the moving bodies. O(n). Throws Error(size | argument).
inline double computePotentialEnergy(const CompactModel& model, Data& data, const VectorArg& q) { return detail::potentialEnergy(model, data, q); }

}  // namespace dyn
