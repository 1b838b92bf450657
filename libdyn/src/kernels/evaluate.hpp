// Asking the joint types: one virtual call a batch.
#pragma once

#include "kernels/workspace.hpp"

namespace dyn::kernels {

/// Whether all numbers are finite: x - x is zero for those, and NaN for all others.
template <class S>
bool allFinite(const S* x, std::ptrdiff_t n) {
  S sum(0);
  for (std::ptrdiff_t i = 0; i < n; ++i) sum += x[i] - x[i];
  return allOf(sum == S(0));
}

/// False if a type that normalises coordinates, as quaternions are, gave a pose that is not finite.
template <class S>
bool posesFinite(const TypeBatch& batch, const JointMemory<S>& memory) {
  return batch.nq == batch.nv || allFinite(memory.pose, poseSize(batch.shape) * memory.stride);
}

/// The call for `count` joints of a batch, all but where q is; `moving`: with biases. Their numbers, and those of their lanes, follow one another.
template <class S>
JointBatch<Real<S>> callFor(const TypeBatch& batch, const std::vector<double>& constants, int count, int lanes, const JointMemory<S>& memory,
                            bool moving) {
  const auto numbers = [](S* x) { return reinterpret_cast<Real<S>*>(x); };
  JointBatch<Real<S>> call;
  call.count = count;
  call.lanes = lanes;
  call.constants = constants.data();
  call.constant_count = batch.constant_count;
  call.constants_stride = count;
  call.stride = call.q_stride = call.v_stride = static_cast<std::ptrdiff_t>(count) * lanes;
  if (memory.v && moving) {
    call.v = numbers(memory.v);
    call.bias = numbers(memory.bias);
  }
  call.pose = numbers(memory.pose);
  call.subspace = numbers(memory.subspace);
  return call;
}

/// Poses, subspaces, and (with v) biases of all joints, into w.joints. q and v are in expanded coordinates. `types`: by batch, in the place
/// of those that the model was compiled with.
template <class S>
void evaluateJoints(const CompactImpl& m, Workspace<S>& w, const S* q, const S* v, const JointType* const* types = nullptr) {
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const JointMemory<S>& memory = w.joints[b];
    JointBatch<Real<S>> call = callFor(batch, batch.constants, batch.count, lanes_of<S>, memory, v != nullptr);
    call.q = reinterpret_cast<const Real<S>*>(memory.q ? memory.q : q + m.index[at(batch.bodies[0])].idx_q);
    if (memory.q)
      for (int k = 0; k < batch.count; ++k)
        for (int c = 0; c < batch.nq; ++c) memory.q[c * batch.count + k] = q[m.index[at(batch.bodies[at(k)])].idx_q + c];
    if (call.v)
      for (int k = 0; k < batch.count; ++k)
        for (int c = 0; c < batch.nv; ++c) memory.v[c * batch.count + k] = v[m.index[at(batch.bodies[at(k)])].idx_v + c];
    (types ? types[b] : batch.fast)->kinematics(call);
  }
}

}  // namespace dyn::kernels
