// Poses, velocities and accelerations of joints and frames.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/spatial/reference_frame.hpp>

namespace dyn {

namespace detail {
DYN_API void forwardKinematics(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a);
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
// Throw Error(argument) for a number out of range, or data of another model.

/// Pose in the world.
DYN_API SE3<double> jointPlacement(const CompactModel& model, const Data& data, int joint);
DYN_API SE3<double> framePlacement(const CompactModel& model, const Data& data, int frame);
/// Spatial velocity.
DYN_API Motion<double> jointVelocity(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameVelocity(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// Spatial acceleration.
DYN_API Motion<double> jointAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// Acceleration of the origin as an observer sees it (linear part), and of the rotation; LOCAL or LOCAL_WORLD_ALIGNED.
DYN_API Motion<double> jointClassicalAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameClassicalAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);

}  // namespace dyn
