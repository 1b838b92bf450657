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

}  // namespace

void neutralOf(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q) {
  ConfigurationBatch<double> b = one(constants, stride);
  b.q_out = q;
  type.neutral(b);
}

Coordinates::Coordinates() : batch_(one(nullptr, 0)) {}

void Coordinates::startAtNeutral(const JointType& type, const double* constants, std::ptrdiff_t stride) {
  batch_.constants = constants;
  batch_.constants_stride = stride;
  batch_.q_out = neutral_;
  batch_.q0 = batch_.q1 = batch_.v = batch_.v_out = nullptr;
  type.neutral(batch_);
  batch_.q_out = nullptr;
  batch_.q0 = neutral_;
}

double Coordinates::of(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q) {
  double value = 0;
  startAtNeutral(type, constants, stride);
  batch_.q1 = q;
  batch_.v_out = &value;
  type.difference(batch_);
  return value;
}

void Coordinates::set(const JointType& type, const double* constants, std::ptrdiff_t stride, double value, double* q) {
  startAtNeutral(type, constants, stride);
  batch_.v = &value;
  batch_.q_out = q;
  type.integrate(batch_);
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
