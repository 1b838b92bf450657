// Dynamics as linear functions of the bodies' inertial parameters.
//
// Ten parameters a joint, the universe left out: pi = (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) of all that moves with the joint,
// in the joint's frame (dyn/spatial/inertial_parameters.hpp); joint j's are at 10 (j - 1). Need Need::derivatives; throw Error(size |
// argument). Atkeson, An and Hollerbach 1986.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/spatial/force.hpp>

namespace dyn {

namespace detail {
DYN_API void bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration, double* out);
DYN_API const double* jointTorqueRegressor(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a);
DYN_API const double* energyRegressor(const CompactModel&, Data&, VectorView q, const VectorView* v);
DYN_API void dynamicParametersOf(const CompactModel&, double* out);
}  // namespace detail

/// 6 x 10: the force on a body, in its frame at its origin, that moves with the given spatial velocity and acceleration, is Y pi.
inline Eigen::Matrix<double, 6, 10> bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration) {
  Eigen::Matrix<double, 6, 10> Y;
  detail::bodyRegressor(velocity, acceleration, Y.data());
  return Y;
}

/// Y, nv x 10 (njoints - 1): rnea without armature and losses is Y pi. O(n depth).
inline MatrixResult computeJointTorqueRegressor(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return {detail::jointTorqueRegressor(model, data, q, v, a), model.nv(), 10 * (model.njoints() - 1)};
}
/// Row of 10 (njoints - 1): the kinetic energy of the bodies (rotors left out) is its product with pi. O(n).
inline VectorResult computeKineticEnergyRegressor(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  const VectorView velocity = v;
  return {detail::energyRegressor(model, data, q, &velocity), 10 * (model.njoints() - 1)};
}
/// The same for the potential energy. O(n).
inline VectorResult computePotentialEnergyRegressor(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::energyRegressor(model, data, q, nullptr), 10 * (model.njoints() - 1)};
}

/// pi of the model as it was compiled.
inline Eigen::VectorXd dynamicParameters(const CompactModel& model) {
  Eigen::VectorXd pi(10 * (model.njoints() - 1));
  detail::dynamicParametersOf(model, pi.data());
  return pi;
}

}  // namespace dyn
