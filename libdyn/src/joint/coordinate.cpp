#include "joint/coordinate.hpp"

namespace dyn {

namespace {

ConfigurationBatch<double> one(const double* constants, std::ptrdiff_t stride) {
  ConfigurationBatch<double> b;
  b.count = 1;
  b.constants = constants;
  b.constants_stride = stride;
  b.q_stride = b.v_stride = 1;
  return b;
}

/// A batch of one joint whose neutral configuration has been written to q.
ConfigurationBatch<double> atNeutral(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q) {
  ConfigurationBatch<double> b = one(constants, stride);
  b.q_out = q;
  type.neutral(b);
  b.q_out = nullptr;
  b.q0 = q;
  return b;
}

}  // namespace

void neutralOf(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q) { atNeutral(type, constants, stride, q); }

double coordinateOf(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q) {
  double neutral[max_joint_nq], value = 0;
  ConfigurationBatch<double> b = atNeutral(type, constants, stride, neutral);
  b.q1 = q;
  b.v_out = &value;
  type.difference(b);
  return value;
}

void setCoordinate(const JointType& type, const double* constants, std::ptrdiff_t stride, double value, double* q) {
  double neutral[max_joint_nq];
  ConfigurationBatch<double> b = atNeutral(type, constants, stride, neutral);
  b.v = &value;
  b.q_out = q;
  type.integrate(b);
}

double normalizeJoint(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q, double* out) {
  double distance = 0;
  ConfigurationBatch<double> b = one(constants, stride);
  b.q0 = q;
  b.q_out = out;
  b.v_out = &distance;
  type.normalize(b);
  return distance;
}

}  // namespace dyn
