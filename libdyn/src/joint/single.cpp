#include "joint/single.hpp"

#include "joint/coordinate.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyn {

namespace {

/// What it writes, all of it.
struct Answer {
  double pose[12] = {}, subspace[6 * max_joint_nv] = {}, bias[6] = {};
};

Answer answerOf(const JointType& type, const JointInstance& instance, const std::vector<double>& constants, const double* q, const double* v) {
  Answer out;
  evaluateJoint(type, instance, constants.data(), q, v, out.pose, out.subspace, out.bias);
  return out;
}

bool alike(const double* a, const double* b, int count) {
  double size = 0, apart = 0;
  for (int k = 0; k < count; ++k) {
    size = std::max(size, std::abs(a[k]));
    apart = std::max(apart, std::abs(a[k] - b[k]));
  }
  return apart <= 1e-6 * size;
}

}  // namespace

bool moveAlike(const JointType& one, const JointType& other, const ParameterArgument* arguments, const JointInstance& instance) {
  std::vector<double> first(static_cast<std::size_t>(instance.constant_count)), second(first);
  one.constants(arguments, first.data());
  other.constants(arguments, second.data());
  double neutral[max_joint_nq], q[max_joint_nq], v[max_joint_nv];
  neutralOf(one, first.data(), 1, neutral);
  for (int k = 0; k < max_joint_nv; ++k) v[k] = 0.3 - 0.08 * k;
  ConfigurationBatch<double> b;
  b.count = 1;
  b.constants = first.data();
  b.constants_stride = b.q_stride = b.v_stride = 1;
  b.q0 = neutral;
  b.v = v;
  b.q_out = q;
  one.integrate(b);
  const Answer a = answerOf(one, instance, first, q, v), c = answerOf(other, instance, second, q, v);
  return alike(a.pose, c.pose, 12) && alike(a.subspace, c.subspace, 6 * max_joint_nv) && alike(a.bias, c.bias, 6);
}

}  // namespace dyn
