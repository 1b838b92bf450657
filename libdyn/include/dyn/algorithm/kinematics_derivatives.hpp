// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of velocities and accelerations of joints and frames.
#pragma once

#include <dyn/algorithm/kinematics.hpp>

namespace dyn {

namespace detail {
enum class Subject { joint, frame };
DYN_API void forwardKinematicsDerivatives(const CompactModel&, Data&, VectorView q, VectorView v, VectorView a);
/// A null pointer stands for a matrix that is not wanted.
DYN_API void motionDerivatives(const CompactModel&, Data&, Subject, int id, ReferenceFrame, const MatrixOut* v_dq, const MatrixOut* v_dv,
                               const MatrixOut* a_dq, const MatrixOut* a_dv, const MatrixOut* a_da);
}  // namespace detail

/// Runs forwardKinematics at (q, v, a) and prepares the derivatives that the functions below return for single joints and frames. O(n). Needs
/// Need::derivatives. Throws Error(size | argument).
inline void computeForwardKinematicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  detail::forwardKinematicsDerivatives(model, data, q, v, a);
}

/// Writes the derivatives of the spatial velocity of a joint or frame to the caller's memory, 6 x nv each, linear part first, in the given reference:
/// by q in its tangent space, and by v. The state is that of the last computeForwardKinematicsDerivatives. O(depth), beside filling the matrices.
/// Throws Error(size | argument), the latter also if computeForwardKinematicsDerivatives has not run. The derivative of a placement is the frame's
/// LOCAL Jacobian. Carpentier and Mansard 2018, extended by the terms of motion subspaces that vary with q.
/// @{
inline void getJointVelocityDerivatives(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& v_dq,
                                        const MatrixOut& v_dv) {
  detail::motionDerivatives(model, data, detail::Subject::joint, joint, reference, &v_dq, &v_dv, nullptr, nullptr, nullptr);
}
inline void getFrameVelocityDerivatives(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& v_dq,
                                        const MatrixOut& v_dv) {
  detail::motionDerivatives(model, data, detail::Subject::frame, frame, reference, &v_dq, &v_dv, nullptr, nullptr, nullptr);
}
/// @}
/// Writes the derivatives of the spatial acceleration, as frameAcceleration returns it, by q, v and a, and that of the velocity by q. The rest is as
/// for the derivatives of the velocity.
/// @{
inline void getJointAccelerationDerivatives(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& v_dq,
                                            const MatrixOut& a_dq, const MatrixOut& a_dv, const MatrixOut& a_da) {
  detail::motionDerivatives(model, data, detail::Subject::joint, joint, reference, &v_dq, nullptr, &a_dq, &a_dv, &a_da);
}
inline void getFrameAccelerationDerivatives(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& v_dq,
                                            const MatrixOut& a_dq, const MatrixOut& a_dv, const MatrixOut& a_da) {
  detail::motionDerivatives(model, data, detail::Subject::frame, frame, reference, &v_dq, nullptr, &a_dq, &a_dv, &a_da);
}
/// @}

}  // namespace dyn
