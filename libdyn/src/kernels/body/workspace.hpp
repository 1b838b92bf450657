// SPDX-License-Identifier: BSD-2-Clause
// The arrays that the recursions write, by body, in scalars S. S is a number, or a pack whose lanes are states (BatchData) or joints (lane groups).
#pragma once

#include "compile/compact_impl.hpp"
#include "kernels/pack/neighbours.hpp"

#include <dyn/scalar/select.hpp>

#include <cstdint>

namespace dyn {

/// Joint results of one batch as its plugin writes them, and the call to the plugin. Component c of joint k is at [c * stride + k].
template <class S>
struct JointMemory {
  S* pose = nullptr;
  S* subspace = nullptr;
  S* bias = nullptr;
  S* q = nullptr;  ///< gathered coordinates, null when the batch reads q in place
  S* v = nullptr;
  std::ptrdiff_t stride = 0;
  JointBatch<Real<S>> call;  ///< prepared once; an evaluation sets q, where it is read in place, and whether there are biases
};

/// One degree of freedom in ABA, as it is eliminated: W = IA S, inverse = 1 / (S^T W + armature), y = inverse * (tau - S^T pA). The last one of a
/// joint is solved first. For it abaInward() leaves W about the parent's origin and multiplied by inverse, and y with the part of beta subtracted.
template <class S>
struct DofFactor {
  Motion<S> column;  ///< column of the motion subspace, aligned axes, at the joint's origin
  Force<S> W;
  S inverse{}, y{};
};

/// Arrays with one number per degree of freedom. Component c of degree of freedom k is at [c * stride + k]. There is room for a pack at the end.
template <class S>
struct Rows {
  S* first = nullptr;
  std::ptrdiff_t stride = 0;
  S* operator[](int component) const { return first + component * stride; }
};

/// Arrays by body, the world included. The stage in brackets writes them.
template <class S>
struct Workspace {
  JointMemory<S>* joints = nullptr;               ///< one per batch
  const InertiaConstants<S>* inertias = nullptr;  ///< by body, of states of different models; otherwise null

  SE3<S>* rel = nullptr;                ///< pose in the parent body's frame [placements]
  SE3<S>* oM = nullptr;                 ///< pose in the world [world placements]
  Motion<S>* v = nullptr;               ///< spatial velocity, body axes at its origin [velocities]
  Motion<S>* a = nullptr;               ///< spatial acceleration, same [accelerations]
  Vec3<S>* sliding = nullptr;           ///< acceleration of the origin due to its own joint, same axes [accelerations; not in batches]
  Vec3<S>* origin = nullptr;            ///< scratch: accelerations of origins
  Vec3<S>* w = nullptr;                 ///< angular velocity: body axes in rnea and local_aba, aligned axes in aba
  Force<S>* f = nullptr;                ///< sum of the children's forces [rnea]; force through joints of varying subspace [aba's derivatives]
  Mat3<S>* R = nullptr;                 ///< body axes in aligned axes [aligned]
  Mat3<S>* product = nullptr;           ///< the same before orthonormalisation [aligned, latency-bound orders]
  Vec3<S>* r = nullptr;                 ///< from the parent's origin to the joint's, aligned axes [aligned]
  Motion<S>* beta = nullptr;            ///< velocity-dependent acceleration, same axes as w [aba]
  ArticulatedInertia<S>* IA = nullptr;  ///< sum of the children's articulated inertias, not at leaves [aba]
  Force<S>* pA = nullptr;               ///< the same for bias forces [aba]; both after the body's own joint is projected out [aba's derivatives]
  Motion<S>* acc = nullptr;             ///< classical acceleration, same axes as w
  S* mass = nullptr;                    ///< sum over the children, like the next two [crba]; of the subtree [com]
  Vec3<S>* h = nullptr;                 ///< first moment about the joint's origin, aligned [crba]; of the subtree [com]
  Sym3<S>* Io = nullptr;                ///< rotational inertia about the same [crba]
  DofFactor<S>* dof = nullptr;          ///< nvx
  int failed[lanes_of<S>] = {};         ///< by lane: the first body whose pivot vanished, or 0 [aba]
};

/// The lanes of the widest packs of columns, in recursions over single states. Arrays that such packs read or write have this much room at the end.
inline constexpr int most_lanes = 32;

/// Lays out arrays in one block of memory. A first pass without a block counts the bytes; a second pass sets the pointers. Each array is aligned for
/// the widest packs.
class Arena {
 public:
  static constexpr std::size_t alignment = PackMemory::alignment;
  explicit Arena(char* base) : base_(base) {}
  template <class T>
  void take(T*& field, std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T>);
    if (base_) field = reinterpret_cast<T*>(base_ + used_);
    used_ += (count * sizeof(T) + alignment - 1) / alignment * alignment;
  }
  template <class S>
  void take(Rows<S>& rows, int components, int count) {
    // A pack may start at any number of a row. The stride is an odd number of cache lines, so that columns do not evict each other from the cache.
    constexpr std::ptrdiff_t line = 8;
    const std::ptrdiff_t stride = lanes_of<S> == 1 ? (((count + line - 1) / line + 1) / 2 * 2 + 1) * line : count;
    if (base_) rows.stride = stride;
    take(rows.first, static_cast<std::size_t>(components * stride));
  }
  std::size_t used() const { return used_; }

 private:
  char* base_;
  std::size_t used_ = 0;
};

/// Lays out the results of `count` joints. `gathered`: there is also room to gather their coordinates.
template <class S>
void layOut(JointMemory<S>& memory, const TypeBatch& batch, int count, bool gathered, Arena& arena) {
  const auto n = static_cast<std::size_t>(count);
  memory = {};
  memory.stride = count;
  arena.take(memory.pose, static_cast<std::size_t>(poseSize(batch.shape)) * n);
  if (batch.shape == Shape::dense) {
    arena.take(memory.subspace, static_cast<std::size_t>(6 * batch.nv) * n);
    arena.take(memory.bias, 6 * n);
    arena.take(memory.v, static_cast<std::size_t>(batch.nv) * n);
  }
  if (gathered) arena.take(memory.q, static_cast<std::size_t>(batch.nq) * n);
}

/// Prepares the call for `count` joints with these constants. The numbers of the joints, and of the lanes of a joint, follow one another.
template <class S>
void prepareCall(JointMemory<S>& memory, const TypeBatch& batch, const std::vector<double>& constants, int count, int lanes) {
  const auto numbers = [](S* x) { return reinterpret_cast<Real<S>*>(x); };
  JointBatch<Real<S>>& call = memory.call;
  call.count = count;
  call.lanes = lanes;
  call.constants = constants.data();
  call.constant_count = batch.constant_count;
  call.constants_stride = count;
  call.stride = call.q_stride = call.v_stride = static_cast<std::ptrdiff_t>(count) * lanes;
  call.q = numbers(memory.q);
  call.pose = numbers(memory.pose);
  call.subspace = numbers(memory.subspace);
}

/// Lays out the joint results of a model, batch by batch.
template <class S>
void layOutJoints(Workspace<S>& w, const CompactImpl& m, Arena& arena) {
  arena.take(w.joints, m.batches.size());
  JointMemory<S> counted;
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    JointMemory<S>& memory = w.joints ? w.joints[b] : counted;
    layOut(memory, batch, batch.count, !batch.contiguous, arena);
    prepareCall(memory, batch, batch.constants, batch.count, lanes_of<S>);
  }
}
/// Lays out the arrays of inverse dynamics, forward dynamics and the mass matrix, for n bodies or lane groups.
template <class S>
void layOutDynamics(Workspace<S>& w, std::size_t n, std::size_t dofs, Arena& arena) {
  arena.take(w.rel, n);
  arena.take(w.w, n);
  arena.take(w.f, n);
  arena.take(w.R, n);
  arena.take(w.r, n);
  arena.take(w.beta, n);
  arena.take(w.IA, n);
  arena.take(w.pA, n);
  arena.take(w.acc, n);
  arena.take(w.mass, n);
  arena.take(w.h, n);
  arena.take(w.Io, n);
  arena.take(w.dof, dofs);
}
template <class S>
void layOut(Workspace<S>& w, const CompactImpl& m, Arena& arena) {
  const auto n = static_cast<std::size_t>(m.bodies());
  layOutJoints(w, m, arena);
  layOutDynamics(w, n, static_cast<std::size_t>(m.nvx), arena);
  arena.take(w.oM, n);
  arena.take(w.v, n);
  arena.take(w.a, n);
  arena.take(w.sliding, n);
  arena.take(w.origin, n);
}

/// Sets the entries of the world that every pass relies on.
template <class S>
void atRest(Workspace<S>& w) {
  w.rel[0] = w.oM[0] = SE3<S>{};
  w.R[0] = Mat3<S>::identity();
  w.v[0] = w.a[0] = {};
  w.w[0] = {};
  w.IA[0] = {};
}

}  // namespace dyn
