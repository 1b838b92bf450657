// SPDX-License-Identifier: BSD-2-Clause
// Evaluates one joint of a type by itself, as a batch of one.
#pragma once

#include <dyn/joint/joint_type.hpp>

namespace dyn {

/// Evaluates a joint of that instance at q. Writes poseSize(shape) numbers of its pose and, for a dense shape, the 6 nv of its subspace and, unless v
/// is null, the 6 of its bias.
template <class S>
void evaluateJoint(const JointType& type, const JointInstance& instance, const double* constants, const S* q, const S* v, S* pose, S* subspace,
                   S* bias) {
  const bool dense = instance.shape == Shape::dense;
  JointBatch<S> b;
  b.count = 1;
  b.constants = constants;
  b.constant_count = instance.constant_count;
  b.constants_stride = 1;
  b.q = q;
  b.q_stride = 1;
  b.v = v;
  b.v_stride = 1;
  b.stride = 1;
  b.pose = pose;
  b.subspace = dense ? subspace : nullptr;
  b.bias = dense && v ? bias : nullptr;
  type.kinematics(b);
}

/// Whether two builds of a type with the same description give joints of this instance that move alike, compared at one configuration off neutral.
/// Differences beyond what compilers and instruction sets round differently count as another motion.
bool moveAlike(const JointType& one, const JointType& other, const ParameterArgument* arguments, const JointInstance& instance);

}  // namespace dyn
