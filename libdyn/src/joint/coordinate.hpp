// One joint's configuration: neutral, normalised, and the one-dimensional coordinate of a coupled joint: how far it is from neutral,
// whatever q looks like.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

// All of one joint, whose constants lie `stride` apart.

void neutralOf(const JointType& type, const double* constants, std::ptrdiff_t stride, double* q);
/// The same question to joint after joint: to clear what it is asked with takes longer than most answers.
class Coordinates {
 public:
  Coordinates();
  double of(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q);
  void set(const JointType& type, const double* constants, std::ptrdiff_t stride, double value, double* q);

 private:
  void startAtNeutral(const JointType& type, const double* constants, std::ptrdiff_t stride);

  ConfigurationBatch<double> batch_;
  double neutral_[max_joint_nq];
};

/// q brought onto the configuration space in `out` (may be null); returns its distance from there before.
double normalizeJoint(const JointType& type, const double* constants, std::ptrdiff_t stride, const double* q, double* out);

}  // namespace dyn
