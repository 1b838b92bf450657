// SPDX-License-Identifier: BSD-2-Clause
// Dynamics as linear functions of the bodies' inertial parameters.
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

/// Returns Y, 6 x 10. Y pi is the force that gives a body with the ten parameters pi (see dynamicParameters) this spatial velocity and acceleration,
/// in its frame at its origin, without gravity.
inline Eigen::Matrix<double, 6, 10> bodyRegressor(const Motion<double>& velocity, const Motion<double>& acceleration) {
  Eigen::Matrix<double, 6, 10> Y;
  detail::bodyRegressor(velocity, acceleration, Y.data());
  return Y;
}

/// Computes Y, nv x 10 (njoints - 1). Y pi is rnea without armature and dissipation, for the parameters pi of dynamicParameters(). O(n depth). This
/// and the functions of energies need Need::derivatives and throw Error(size | argument). Atkeson, An and Hollerbach 1986.
inline MatrixResult computeJointTorqueRegressor(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  return {detail::jointTorqueRegressor(model, data, q, v, a), model.nv(), 10 * (model.njoints() - 1)};
}
/// Computes a row of 10 (njoints - 1) numbers. Its product with pi is the kinetic energy of the bodies [J], without armature. O(n).
inline VectorResult computeKineticEnergyRegressor(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  const VectorView velocity = v;
  return {detail::energyRegressor(model, data, q, &velocity), 10 * (model.njoints() - 1)};
}
/// Computes such a row for the potential energy. O(n).
inline VectorResult computePotentialEnergyRegressor(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::energyRegressor(model, data, q, nullptr), 10 * (model.njoints() - 1)};
}

/// Returns pi of the model as it was compiled. Each joint has ten parameters (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz): those of its body
/// and all bodies welded to it, in the joint's frame (dyn/spatial/inertial_parameters.hpp). The world has none: those of joint j begin at 10 (j - 1).
inline Eigen::VectorXd dynamicParameters(const CompactModel& model) {
  Eigen::VectorXd pi(10 * (model.njoints() - 1));
  detail::dynamicParametersOf(model, pi.data());
  return pi;
}

}  // namespace dyn
