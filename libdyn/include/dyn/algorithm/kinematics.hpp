// Poses, velocities and accelerations of joints and frames; Jacobians of frames and their time derivatives.
#pragma once

#include <dyn/data/data.hpp>

namespace dyn {

/// Where a frame's velocity or Jacobian is expressed:
///   LOCAL                the frame's own axes, at its origin
///   WORLD                world axes, the velocity of the body's point at the world's origin
///   LOCAL_WORLD_ALIGNED  world axes, at the frame's origin
enum class ReferenceFrame { LOCAL, WORLD, LOCAL_WORLD_ALIGNED };

namespace detail {
DYN_API void forwardKinematics(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a);
DYN_API void frameJacobian(const CompactModel&, Data&, VectorView q, int frame, ReferenceFrame, double* J);
DYN_API void frameJacobianTimeVariation(const CompactModel&, Data&, VectorView q, VectorView v, int frame, ReferenceFrame, double* dJ);
}  // namespace detail

/// Poses of all joints; with v, velocities; with a, accelerations (gravity not included). O(n). Throws Error(size | argument).
inline void forwardKinematics(const CompactModel& model, Data& data, const VectorArg& q) {
  detail::forwardKinematics(model, data, q, nullptr, nullptr);
}
inline void forwardKinematics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v) {
  const VectorView vv = v;
  detail::forwardKinematics(model, data, q, &vv, nullptr);
}
inline void forwardKinematics(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, const VectorArg& a) {
  const VectorView vv = v, aa = a;
  detail::forwardKinematics(model, data, q, &vv, &aa);
}

// What the last forwardKinematics of sufficient order found, O(1). Joint and frame numbers are those of the model.
// Throw Error(argument) for a number out of range.

/// Pose in the world.
DYN_API SE3<double> jointPlacement(const CompactModel& model, const Data& data, int joint);
DYN_API SE3<double> framePlacement(const CompactModel& model, const Data& data, int frame);
/// Spatial velocity.
DYN_API Motion<double> frameVelocity(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// Spatial acceleration.
DYN_API Motion<double> frameAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// Acceleration of the frame's origin as an observer sees it (linear part), and of its rotation; LOCAL or LOCAL_WORLD_ALIGNED.
DYN_API Motion<double> frameClassicalAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);

/// J with J v = velocity of the frame in the given reference: writes 6 x nv, column-major (6 rows, linear first). O(depth) and exact
/// however far the base stands. The matrix is the caller's; throws Error(size) if it is not 6 x nv.
template <class Derived>
void computeFrameJacobian(const CompactModel& model, Data& data, const VectorArg& q, int frame, ReferenceFrame reference,
                          Eigen::PlainObjectBase<Derived>& J);
/// dJ/dt at velocity v, the derivative of what computeFrameJacobian returns.
template <class Derived>
void computeFrameJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int frame,
                                       ReferenceFrame reference, Eigen::PlainObjectBase<Derived>& dJ);

namespace detail {
DYN_API void wantSize(const char* algorithm, const char* name, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t want_rows,
                      std::ptrdiff_t want_cols);
}

template <class Derived>
void computeFrameJacobian(const CompactModel& model, Data& data, const VectorArg& q, int frame, ReferenceFrame reference,
                          Eigen::PlainObjectBase<Derived>& J) {
  static_assert(!Derived::IsRowMajor, "J is written column after column");
  detail::wantSize("computeFrameJacobian", "J", J.rows(), J.cols(), 6, model.nv());
  detail::frameJacobian(model, data, q, frame, reference, J.data());
}

template <class Derived>
void computeFrameJacobianTimeVariation(const CompactModel& model, Data& data, const VectorArg& q, const VectorArg& v, int frame,
                                       ReferenceFrame reference, Eigen::PlainObjectBase<Derived>& dJ) {
  static_assert(!Derived::IsRowMajor, "dJ is written column after column");
  detail::wantSize("computeFrameJacobianTimeVariation", "dJ", dJ.rows(), dJ.cols(), 6, model.nv());
  detail::frameJacobianTimeVariation(model, data, q, v, frame, reference, dJ.data());
}

}  // namespace dyn
