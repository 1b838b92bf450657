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

/// Poses, subspaces, and (with v) biases of all joints, into w.joints. q and v are in expanded coordinates. `types`: by batch, in the place
/// of those that the model was compiled with.
template <class S>
void evaluateJoints(const CompactImpl& m, Workspace<S>& w, const S* q, const S* v, const JointType* const* types = nullptr) {
  using T = Real<S>;
  constexpr int lanes = lanes_of<S>;
  const auto at = [](int i) { return static_cast<std::size_t>(i); };
  const auto numbers = [](auto* x) { return reinterpret_cast<T*>(x); };
  const auto constNumbers = [](const S* x) { return reinterpret_cast<const T*>(x); };
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const JointMemory<S>& memory = w.joints[b];
    JointBatch<T> call;
    call.count = batch.count;
    call.lanes = lanes;
    call.constants = batch.constants.data();
    call.constant_count = batch.constant_count;
    call.constants_stride = batch.count;
    call.stride = memory.stride * lanes;
    call.q_stride = call.v_stride = batch.count * lanes;
    if (memory.q) {
      for (int k = 0; k < batch.count; ++k)
        for (int c = 0; c < batch.nq; ++c) memory.q[c * batch.count + k] = q[m.index[at(batch.bodies[at(k)])].idx_q + c];
      call.q = numbers(memory.q);
    } else {
      call.q = constNumbers(q + m.index[at(batch.bodies[0])].idx_q);
    }
    if (memory.v && v) {
      for (int k = 0; k < batch.count; ++k)
        for (int c = 0; c < batch.nv; ++c) memory.v[c * batch.count + k] = v[m.index[at(batch.bodies[at(k)])].idx_v + c];
      call.v = numbers(memory.v);
      call.bias = numbers(memory.bias);
    }
    call.pose = numbers(memory.pose);
    call.subspace = numbers(memory.subspace);
    (types ? types[b] : batch.fast)->kinematics(call);
  }
}

}  // namespace dyn::kernels
