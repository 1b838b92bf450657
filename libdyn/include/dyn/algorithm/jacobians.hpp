// SPDX-License-Identifier: BSD-2-Clause
// Jacobians of joints and frames, and their time derivatives.
#pragma once

#include <dyn/algorithm/kinematics.hpp>

namespace dyn {

namespace detail {
/// The subject of a Jacobian: one joint or one frame, whose number is `id`, or all joints at once.
enum class Kind { joint, frame, all_joints };
DYN_API void jacobian(const CompactModel&, Data&, VectorView q, Kind, int id, ReferenceFrame, const MatrixOut& J);
DYN_API const double* jointJacobians(const CompactModel&, Data&, VectorView q);
DYN_API void jacobianTimeVariation(const CompactModel&, Data&, VectorView q, VectorView v, Kind, int id, ReferenceFrame, const MatrixOut& dJ);
}  // namespace detail

/// Writes J, 6 x nv, linear part first, to the caller's matrix or block of a matrix. J v is the spatial velocity of the joint or frame in the given
/// reference. The cost is O(depth) on top of the kinematics, which run first. A base far from the origin costs no accuracy. The motion of a dependent
/// joint is part of its master's column. Throws Error(size | argument), for example if J is not 6 x nv or a number is out of range.
/// @{
inline void computeJointJacobian(const CompactModel& model, Data& data, const VectorArg& q, int joint, ReferenceFrame reference, const MatrixOut& J) {
  detail::jacobian(model, data, q, detail::Kind::joint, joint, reference, J);
}
inline void computeFrameJacobian(const CompactModel& model, Data& data, const VectorArg& q, int frame, ReferenceFrame reference, const MatrixOut& J) {
  detail::jacobian(model, data, q, detail::Kind::frame, frame, reference, J);
}
/// @}

/// Computes the columns of all joints' Jacobians at once, 6 x nv: column k is the spatial velocity in WORLD for unit v_k. The Jacobian of one joint
/// has the columns of the joints on its root path. Poses are left as by forwardKinematics. O(n). Throws
/// Error(size | argument), the latter also for a model with dependent joints.
inline MatrixResult computeJointJacobians(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::jointJacobians(model, data, q), 6, model.nv()};
}

/// Writes the same as computeJointJacobian and computeFrameJacobian, at the q of the last forwardKinematics or computeJointJacobians, in O(depth).
/// Use these for several frames at one q. No other q may have been used with this data since. Throws Error(size | argument), the latter also if no
/// kinematics have run.
/// @{
DYN_API void getJointJacobian(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& J);
DYN_API void getFrameJacobian(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& J);
/// @}

/// Writes dJ/dt along v, 6 x nv: the time derivative of the matrix that the functions above write, in any reference. Throws Error(size | argument).
/// @{
inline void computeJointJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int joint,
                                              ReferenceFrame reference, const MatrixOut& dJ) {
  detail::jacobianTimeVariation(model, data, q, v, detail::Kind::joint, joint, reference, dJ);
}
inline void computeFrameJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int frame,
                                              ReferenceFrame reference, const MatrixOut& dJ) {
  detail::jacobianTimeVariation(model, data, q, v, detail::Kind::frame, frame, reference, dJ);
}
/// @}

}  // namespace dyn
