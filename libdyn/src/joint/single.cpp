// SPDX-License-Identifier: BSD-2-Clause
#include "joint/single.hpp"

#include "joint/coordinate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace dyn {

namespace {

/// Everything that a joint type writes for one joint.
struct Answer {
  double pose[12] = {}, subspace[6 * max_joint_nv] = {}, bias[6] = {};
};

Answer answerOf(const JointType& type, const JointInstance& instance, const std::vector<double>& constants, const double* q, const double* v) {
  Answer out;
  evaluateJoint(type, instance, constants.data(), q, v, out.pose, out.subspace, out.bias);
  return out;
}

double largest(const double* a, int count) {
  return std::accumulate(a, a + count, 0.0, [](double size, double x) { return std::max(size, std::abs(x)); });
}

/// Whether a and b differ only by rounding; numbers of size `scale` may have cancelled in them.
bool alike(const double* a, const double* b, int count, double scale) {
  double apart = 0;
  for (int k = 0; k < count; ++k) apart = std::max(apart, std::abs(a[k] - b[k]));
  return apart <= 1e-6 * largest(a, count) + 1e-13 * scale;
}

}  // namespace

bool moveAlike(const JointType& one, const JointType& other, const ParameterArgument* arguments, const JointInstance& instance) {
  std::vector<double> first(static_cast<std::size_t>(instance.constant_count)), second(first);
  one.constants(arguments, first.data());
  other.constants(arguments, second.data());
  double neutral[max_joint_nq], q[max_joint_nq], v[max_joint_nv];
  const JointPlace joint{&one, first.data(), instance.constant_count};
  neutralOf(joint, neutral);
  for (int k = 0; k < max_joint_nv; ++k) v[k] = 0.3 - 0.08 * k;
  ConfigurationBatch<double> b = joint.question();
  b.q0 = neutral;
  b.v = v;
  b.q_out = q;
  one.integrate(b);
  const Answer a = answerOf(one, instance, first, q, v), c = answerOf(other, instance, second, q, v);
  const double scale = largest(a.pose, 12);
  return alike(a.pose, c.pose, 12, scale) && alike(a.subspace, c.subspace, 6 * max_joint_nv, scale) && alike(a.bias, c.bias, 6, scale);
}

}  // namespace dyn
