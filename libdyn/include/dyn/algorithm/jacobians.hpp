// Jacobians of joints and frames, and their time derivatives.
#pragma once

#include <dyn/algorithm/kinematics.hpp>

namespace dyn {

namespace detail {
/// Of a joint or of a frame, whose number is `id`; or of all joints at once.
enum class Kind { joint, frame, all_joints };
DYN_API void jacobian(const CompactModel&, Data&, VectorView q, Kind, int id, ReferenceFrame, const MatrixOut& J);
DYN_API const double* jointJacobians(const CompactModel&, Data&, VectorView q);
DYN_API void jacobianTimeVariation(const CompactModel&, Data&, VectorView q, VectorView v, Kind, int id, ReferenceFrame, const MatrixOut& dJ);
}  // namespace detail

// J v is the spatial velocity of the joint or frame in the reference asked for; J is 6 x nv, linear part first, and the caller's: a
// matrix or a block of one. O(depth) beside the kinematics, and as exact when the base stands far away. A follower's motion is its
// master's column. Throw Error(size) if J is not 6 x nv, Error(argument) for a number out of range.

inline void computeJointJacobian(const CompactModel& model, Data& data, const VectorArg& q, int joint, ReferenceFrame reference, const MatrixOut& J) {
  detail::jacobian(model, data, q, detail::Kind::joint, joint, reference, J);
}
inline void computeFrameJacobian(const CompactModel& model, Data& data, const VectorArg& q, int frame, ReferenceFrame reference, const MatrixOut& J) {
  detail::jacobian(model, data, q, detail::Kind::frame, frame, reference, J);
}

/// Of all joints at once: column k is the motion of unit v_k in WORLD, 6 x nv, and poses as forwardKinematics leaves them. The Jacobian of
/// a joint has the columns of the joints between it and the root. Throws Error(argument) for a model with joints that follow others. O(n).
inline MatrixResult computeJointJacobians(const CompactModel& model, Data& data, const VectorArg& q) {
  return {detail::jointJacobians(model, data, q), 6, model.nv()};
}

/// As computeJointJacobian and computeFrameJacobian at the q of the last forwardKinematics or computeJointJacobians, for several frames at
/// one q. No other q may have been used with this data since.
DYN_API void getJointJacobian(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& J);
DYN_API void getFrameJacobian(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& J);

/// dJ/dt along v: the derivative of the matrix that the functions above write, whatever the reference.
inline void computeJointJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int joint,
                                              ReferenceFrame reference, const MatrixOut& dJ) {
  detail::jacobianTimeVariation(model, data, q, v, detail::Kind::joint, joint, reference, dJ);
}
inline void computeFrameJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int frame,
                                              ReferenceFrame reference, const MatrixOut& dJ) {
  detail::jacobianTimeVariation(model, data, q, v, detail::Kind::frame, frame, reference, dJ);
}

}  // namespace dyn
