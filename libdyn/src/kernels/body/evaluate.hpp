// SPDX-License-Identifier: BSD-2-Clause
// Evaluates the joint types, with one virtual call per batch.
#pragma once

#include "kernels/body/workspace.hpp"

#include <algorithm>

namespace dyn::kernels {

/// Whether all numbers are finite: x - x is zero for finite numbers and NaN for all others.
template <class S>
bool allFinite(const S* x, std::ptrdiff_t n) {
  S sum(0);
  for (std::ptrdiff_t i = 0; i < n; ++i) sum += x[i] - x[i];
  return allOf(sum == S(0));
}

/// Returns false if a type that normalises coordinates, such as quaternions, gave a pose that is not finite. Types with nq = nv are not checked.
template <class S>
bool posesFinite(const TypeBatch& batch, const JointMemory<S>& memory) {
  return batch.nq == batch.nv || allFinite(memory.pose, poseSize(batch.shape) * memory.stride);
}

/// Computes dq/dt at q for velocities v, for `count` joints of a batch from slot `first` on, with `lanes` states each. The items follow one another.
/// Derivatives that q and v carry are propagated.
inline void coordinateRates(const TypeBatch& batch, int first, int count, int lanes, const Dual<double>* q, const Dual<double>* v, Dual<double>* dq) {
  const std::ptrdiff_t items = static_cast<std::ptrdiff_t>(count) * lanes;
  if (!batch.curved) {
    std::copy_n(v, batch.nv * items, dq);
    return;
  }
  ConfigurationBatch<Dual<double>> call = batch.placeOf(first).question<Dual<double>>();
  call.count = count;
  call.lanes = lanes;
  call.q_stride = call.v_stride = items;
  call.q0 = q;
  call.v = v;
  call.q_out = dq;
  batch.type->rates(call);
}

/// Calls a joint type to fill a batch's memory. q points at the first of the batch's coordinates; they are read in place unless they have been
/// gathered. With `moving` the type also writes biases.
template <class S>
void evaluateBatch(const JointType& type, JointMemory<S>& memory, const S* q, bool moving) {
  const auto numbers = [](const S* x) { return reinterpret_cast<const Real<S>*>(x); };
  JointBatch<Real<S>>& call = memory.call;
  if (!memory.q) call.q = numbers(q);
  if (memory.v) {
    call.v = moving ? numbers(memory.v) : nullptr;
    call.bias = moving ? reinterpret_cast<Real<S>*>(memory.bias) : nullptr;
  }
  type.kinematics(call);
}

/// Writes the poses, subspaces and (with v) biases of all joints to w.joints. q and v are in expanded coordinates. `types`, one per batch, replace
/// the types that the model was compiled with.
template <class S>
void evaluateJoints(const CompactImpl& m, Workspace<S>& w, const S* q, const S* v, const JointType* const* types = nullptr) {
  const auto gather = [](const S* from, const std::vector<int>& index, int size, S* to) {
    const auto count = static_cast<int>(index.size());
    for (int c = 0; c < size; ++c)
      for (int k = 0; k < count; ++k) to[c * count + k] = from[index[static_cast<std::size_t>(k)] + c];
  };
  // All batches are gathered before the first call: the types read in packs what is written here number by number.
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    const JointMemory<S>& memory = w.joints[b];
    if (memory.q) gather(q, batch.q_index, batch.nq, memory.q);
    if (memory.v && v) gather(v, batch.v_index, batch.nv, memory.v);
  }
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    evaluateBatch(types ? *types[b] : *batch.fast, w.joints[b], q + batch.q_index[0], v != nullptr);
  }
}

}  // namespace dyn::kernels
