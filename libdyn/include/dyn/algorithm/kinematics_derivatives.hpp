// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of velocities and accelerations of joints and frames.
//
// Call computeForwardKinematicsDerivatives once, then a get function for each joint or frame. It writes 6 x nv matrices in the caller's memory,
// linear part first, in the given reference, with respect to q in its tangent space. The derivative of a placement is the frame's LOCAL
// Jacobian. Accelerations are spatial, as frameAcceleration returns them. O(depth) a frame. The functions need Need::derivatives and throw
// Error(size | argument). Carpentier and Mansard 2018, extended by the terms of motion subspaces that vary with q.
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

inline void computeForwardKinematicsDerivatives(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  detail::forwardKinematicsDerivatives(model, data, q, v, a);
}

inline void getJointVelocityDerivatives(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& v_dq,
                                        const MatrixOut& v_dv) {
  detail::motionDerivatives(model, data, detail::Subject::joint, joint, reference, &v_dq, &v_dv, nullptr, nullptr, nullptr);
}
inline void getFrameVelocityDerivatives(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& v_dq,
                                        const MatrixOut& v_dv) {
  detail::motionDerivatives(model, data, detail::Subject::frame, frame, reference, &v_dq, &v_dv, nullptr, nullptr, nullptr);
}
inline void getJointAccelerationDerivatives(const CompactModel& model, Data& data, int joint, ReferenceFrame reference, const MatrixOut& v_dq,
                                            const MatrixOut& a_dq, const MatrixOut& a_dv, const MatrixOut& a_da) {
  detail::motionDerivatives(model, data, detail::Subject::joint, joint, reference, &v_dq, nullptr, &a_dq, &a_dv, &a_da);
}
inline void getFrameAccelerationDerivatives(const CompactModel& model, Data& data, int frame, ReferenceFrame reference, const MatrixOut& v_dq,
                                            const MatrixOut& a_dq, const MatrixOut& a_dv, const MatrixOut& a_da) {
  detail::motionDerivatives(model, data, detail::Subject::frame, frame, reference, &v_dq, nullptr, &a_dq, &a_dv, &a_da);
}

}  // namespace dyn
