// SPDX-License-Identifier: BSD-2-Clause
#include "joint/coordinate.hpp"

namespace dyn {

void neutralOf(const JointPlace& joint, double* q) {
  ConfigurationBatch<double> b = joint.question();
  b.q_out = q;
  joint.type->neutral(b);
}

Coordinates::Coordinates() : batch_(JointPlace{}.question()) {}

void Coordinates::startAtNeutral(const JointPlace& joint) {
  batch_.constants = joint.constants;
  batch_.constant_count = joint.constant_count;
  batch_.constants_stride = joint.stride;
  batch_.q_out = neutral_;
  batch_.q0 = batch_.q1 = batch_.v = batch_.v_out = nullptr;
  joint.type->neutral(batch_);
  batch_.q_out = nullptr;
  batch_.q0 = neutral_;
}

double Coordinates::of(const JointPlace& joint, const double* q) {
  double value = 0;
  startAtNeutral(joint);
  batch_.q1 = q;
  batch_.v_out = &value;
  joint.type->difference(batch_);
  return value;
}

void Coordinates::set(const JointPlace& joint, double value, double* q) {
  startAtNeutral(joint);
  batch_.v = &value;
  batch_.q_out = q;
  joint.type->integrate(batch_);
}

double normalizeJoint(const JointPlace& joint, const double* q, double* out) {
  double distance = 0;
  ConfigurationBatch<double> b = joint.question();
  b.q0 = q;
  b.q_out = out;
  b.v_out = &distance;
  joint.type->normalize(b);
  return distance;
}

}  // namespace dyn
