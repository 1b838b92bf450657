// SPDX-License-Identifier: BSD-2-Clause
// Poses, velocities and accelerations of joints and frames.
#pragma once

#include <dyn/data/data.hpp>
#include <dyn/spatial/reference_frame.hpp>

namespace dyn {

namespace detail {
DYN_API void forwardKinematics(const CompactModel&, Data&, VectorView q, const VectorView* v, const VectorView* a);
}  // namespace detail

/// Computes the poses of all joints; with v their velocities, too; with a also their accelerations (gravity not included). O(n).
/// Throws Error(size | argument).
/// @{
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
/// @}

/// Returns the pose of a joint or frame in the world, as the last forwardKinematics found it. O(1). Joint and frame numbers are those of the model.
///
/// This and the functions below throw Error(argument) for a number out of range, for data of another model, and if the last forwardKinematics had no
/// v or a where one is needed.
/// @{
DYN_API SE3<double> jointPlacement(const CompactModel& model, const Data& data, int joint);
DYN_API SE3<double> framePlacement(const CompactModel& model, const Data& data, int frame);
/// @}
/// Returns the spatial velocity [m/s, rad/s] in the given reference. O(1).
/// @{
DYN_API Motion<double> jointVelocity(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameVelocity(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// @}
/// Returns the spatial acceleration [m/s^2, rad/s^2] in the given reference, gravity not included. O(1).
/// @{
DYN_API Motion<double> jointAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// @}
/// Returns the classical acceleration [m/s^2, rad/s^2]. Its linear part is the acceleration of the origin as an observer sees it, its angular part
/// that of the rotation. O(depth). The reference is LOCAL or LOCAL_WORLD_ALIGNED; WORLD throws Error(argument).
/// @{
DYN_API Motion<double> jointClassicalAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference);
DYN_API Motion<double> frameClassicalAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference);
/// @}

}  // namespace dyn
