// SPDX-License-Identifier: BSD-2-Clause
// One joint's configuration: the neutral one, normalisation, and the scalar coordinate of a coupled joint. That coordinate is the displacement from
// neutral, whatever form q has.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

/// A joint and its constants; number c is at constants[c * stride].
struct JointPlace {
  const JointType* type = nullptr;
  const double* constants = nullptr;
  int constant_count = 0;
  std::ptrdiff_t stride = 1;

  /// Returns a batch of this joint alone for one call. The caller sets the arrays.
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
/// Reads and sets the scalar coordinates of joint after joint with one batch: to clear a batch takes longer than most calls.
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

/// Writes q, normalised, to `out` (may be null). Returns how far q was from the configuration space.
double normalizeJoint(const JointPlace& joint, const double* q, double* out);

}  // namespace dyn
