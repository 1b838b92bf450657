// SPDX-License-Identifier: BSD-2-Clause
#include <dyn/model/constraint.hpp>
#include <dyn/model/model.hpp>

namespace dyn {

namespace {
ConstraintDescription between(const std::string& name, const FrameConstraint& relation) {
  ConstraintDescription c;
  c.name = name;
  c.relation = relation;
  return c;
}
}  // namespace

ConstraintDescription pointContact(const std::string& frame, const std::string& other) {
  FrameConstraint c;
  c.frame = frame;
  c.other = other;
  c.free = {false, false, false, true, true, true};
  return between(frame, c);
}

ConstraintDescription frameContact(const std::string& frame, const std::string& other) {
  FrameConstraint c;
  c.frame = frame;
  c.other = other;
  return between(frame, c);
}

ConstraintDescription closeLoop(const std::string& name, const std::string& frame, const std::string& other, const std::array<bool, 6>& free) {
  FrameConstraint c;
  c.frame = frame;
  c.other = other;
  c.free = free;
  c.axes = ConstraintAxes::OTHER;
  c.has_target = true;
  return between(name, c);
}

ConstraintDescription coupleJoint(const std::string& joint, const Coupling& coupling) {
  ConstraintDescription c;
  c.name = joint;
  c.relation = JointCoupling{joint, coupling};
  return c;
}

ConstraintDescription lockJoint(const std::string& joint, const std::vector<double>& configuration) {
  ConstraintDescription c;
  c.name = joint;
  c.relation = JointLock{joint, configuration};
  return c;
}

}  // namespace dyn
