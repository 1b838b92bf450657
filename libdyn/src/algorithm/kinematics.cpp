// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "algorithm/support/placement.hpp"
#include "at.hpp"
#include "kernels/isa/table.hpp"

#include <dyn/error.hpp>

#include <string>

namespace dyn {

namespace {

/// Returns the results of the last forwardKinematics. Throws Error(argument) if they do not reach `stage`.
const DataImpl& found(const char* function, const CompactModel& model, const Data& data, KinematicsStage stage) {
  checkData(function, model, data);
  checkStage(function, data.impl().stage, stage);
  return data.impl();
}

int checked(const char* what, int id, int count) {
  if (id < 0 || id >= count)
    throw Error(ErrorCode::argument, std::string(what) + " " + std::to_string(id) + " does not exist; the model has " + std::to_string(count));
  return id;
}

Motion<double> velocityOf(const PointOnBody& x, const DataImpl& d, ReferenceFrame reference) {
  return express(x.placement.actInv(d.v[x.body]), d.oM[x.body] * x.placement, reference);
}

Motion<double> accelerationOf(const PointOnBody& x, const DataImpl& d, ReferenceFrame reference) {
  return express(x.placement.actInv(d.a[x.body]), d.oM[x.body] * x.placement, reference);
}

Motion<double> classicalAccelerationOf(const char* function, const CompactModel& model, const Data& data, const PointOnBody& x,
                                       ReferenceFrame reference) {
  const DataImpl& d = found(function, model, data, KinematicsStage::accelerations);
  if (reference == ReferenceFrame::WORLD)
    throw Error(ErrorCode::argument, std::string(function) + ": an origin's acceleration has no WORLD form; use LOCAL or LOCAL_WORLD_ALIGNED");
  return express(originAccelerationOf(model.impl(), x, d), d.oM[x.body] * x.placement, reference);
}

}  // namespace

PointOnBody frameOnBody(const CompactModel& model, int frame) {
  const CompactImpl& m = model.impl();
  const std::size_t f = at(checked("frame", frame, static_cast<int>(m.frames.size())));
  return {m.frame_body[f], m.frame_placement[f]};
}

PointOnBody jointOnBody(const CompactModel& model, int joint) {
  const CompactImpl& m = model.impl();
  const std::size_t j = at(checked("joint", joint, model.njoints()));
  return {m.body_of_joint[j], m.user_frame[j]};
}

namespace detail {

void forwardKinematics(const CompactModel& model, Data& data, VectorView q, const VectorView* v, const VectorView* a) {
  const Inputs in = readInputs("forwardKinematics", model, data, q, v, a);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  evaluateJoints(m, d, in.q, v ? in.v : nullptr);
  kernels::active().single.forwardKinematics(m, d, v ? in.v : nullptr, a ? in.a : nullptr);
  d.stage = a ? KinematicsStage::accelerations : v ? KinematicsStage::velocities : KinematicsStage::poses;
}

}  // namespace detail

SE3<double> jointPlacement(const CompactModel& model, const Data& data, int joint) {
  const DataImpl& d = found("jointPlacement", model, data, KinematicsStage::poses);
  const PointOnBody x = jointOnBody(model, joint);
  return d.oM[x.body] * x.placement;
}
SE3<double> framePlacement(const CompactModel& model, const Data& data, int frame) {
  const DataImpl& d = found("framePlacement", model, data, KinematicsStage::poses);
  const PointOnBody x = frameOnBody(model, frame);
  return d.oM[x.body] * x.placement;
}

Motion<double> jointVelocity(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference) {
  return velocityOf(jointOnBody(model, joint), found("jointVelocity", model, data, KinematicsStage::velocities), reference);
}
Motion<double> frameVelocity(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  return velocityOf(frameOnBody(model, frame), found("frameVelocity", model, data, KinematicsStage::velocities), reference);
}

Motion<double> jointAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference) {
  return accelerationOf(jointOnBody(model, joint), found("jointAcceleration", model, data, KinematicsStage::accelerations), reference);
}
Motion<double> frameAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  return accelerationOf(frameOnBody(model, frame), found("frameAcceleration", model, data, KinematicsStage::accelerations), reference);
}

Motion<double> jointClassicalAcceleration(const CompactModel& model, const Data& data, int joint, ReferenceFrame reference) {
  return classicalAccelerationOf("jointClassicalAcceleration", model, data, jointOnBody(model, joint), reference);
}
Motion<double> frameClassicalAcceleration(const CompactModel& model, const Data& data, int frame, ReferenceFrame reference) {
  return classicalAccelerationOf("frameClassicalAcceleration", model, data, frameOnBody(model, frame), reference);
}

}  // namespace dyn
