// Centre of mass, its motion and Jacobian, and energies. Only what moves counts: bodies welded to the world carry no part.
#pragma once

#include <dyn/data/data.hpp>

namespace dyn {

/// World frame, of the last call that computed it.
struct CenterOfMass {
  Vec3<double> position, velocity, acceleration;  ///< [m, m/s, m/s^2]; gravity not included
};

namespace detail {
DYN_API CenterOfMass centerOfMass(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a);
DYN_API const double* jacobianCenterOfMass(const CompactModel&, Data&, VectorView q);
DYN_API double kineticEnergy(const CompactModel&, Data&, VectorView q, VectorView v);
DYN_API double potentialEnergy(const CompactModel&, Data&, VectorView q);
}  // namespace detail

/// Runs forwardKinematics of the order given. O(n). A model without mass has its centre at NaN.
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
/// 3 x nv, world axes: velocity of the centre of mass = Jcom v. O(n).
inline MatrixResult jacobianCenterOfMass(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::jacobianCenterOfMass(model, data, q), 3, model.nv()};
}
/// v^T M v / 2, armature included [J]. O(n).
inline double computeKineticEnergy(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  return detail::kineticEnergy(model, data, q, v);
}
/// - sum m g . c over the moving bodies [J]. O(n).
inline double computePotentialEnergy(const CompactModel& model, Data& data, const VectorArg& q) { return detail::potentialEnergy(model, data, q); }

}  // namespace dyn
