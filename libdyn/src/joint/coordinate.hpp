// One joint's configuration: neutral, normalised, and the one-dimensional coordinate of a coupled joint: how far it is from neutral,
// whatever q looks like.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

/// A joint and where its constants are: number c at constants[c * stride].
struct JointPlace {
  const JointType* type = nullptr;
  const double* constants = nullptr;
  int constant_count = 0;
  std::ptrdiff_t stride = 1;

  /// To ask one question of this joint alone: the arrays are still to be set.
  template <class S = double>
  ConfigurationBatch<S> question() const {
    ConfigurationBatch<S> b;
    b.count = 1;
    b.constants = constants;
    b.constant_count = constant_count;
    b.constants_stride = stride;
    b.q_stride = b.v_stride = b.j_stride = 1;
    return b;
  }
};

void neutralOf(const JointPlace& joint, double* q);
/// The same question to joint after joint: to clear what it is asked with takes longer than most answers.
class Coordinates {
 public:
  Coordinates();
  double of(const JointPlace& joint, const double* q);
  void set(const JointPlace& joint, double value, double* q);

 private:
  void startAtNeutral(const JointPlace& joint);

  ConfigurationBatch<double> batch_;
  double neutral_[max_joint_nq];
};

/// q brought onto the configuration space in `out` (may be null); returns its distance from there before.
double normalizeJoint(const JointPlace& joint, const double* q, double* out);

}  // namespace dyn
