// Recursions over strips: the kernels for bodies, with four joints in the lanes of a pack.
//
// A second text wins 15 % on two robots, or goes. CompileOptions::strips = false shows what these win, as one body after the other against strips
// (AVX-512, single states): HyQ and ANYmal take 1.46 and 1.47 times as long for rnea, 1.41 and 1.37 for aba, 1.42 and 1.48 for crba, 1.26 and 1.30
// for minverse, 1.27 and 1.30 for the derivatives of rnea, 1.20 and 1.25 for ccrba; TALOS 1.33 for rnea, 1.13 for aba and 1.04 for the derivatives.
#pragma once

#include "kernels/aba.hpp"
#include "kernels/crba.hpp"
#include "kernels/evaluate.hpp"
#include "kernels/losses.hpp"
#include "kernels/rnea.hpp"
#include "kernels/scratch.hpp"
#include "kernels/strip_map.hpp"
#include "kernels/strip_scratch.hpp"
#include "kernels/strips.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

/// The only joint of its type, which is most often a flying root: asked once, and given to all lanes. False as posesFinite().
template <class S>
bool evaluateAlone(const TypeBatch& batch, JointMemory<double>& one, const JointMemory<S>& lanes, const double* q, const double* v) {
  if (one.v && v) std::copy_n(v, batch.nv, one.v);
  ask(*batch.fast, one, q, v != nullptr);
  const auto spread = [](const double* from, int count, S* to) {
    for (int k = 0; k < count; ++k) to[k] = S(from[k]);
  };
  spread(one.pose, poseSize(batch.shape), lanes.pose);
  if (one.subspace) spread(one.subspace, 6 * batch.nv, lanes.subspace);
  if (one.bias && v) spread(one.bias, 6, lanes.bias);
  // In packs: behind the pose there are zeros.
  return batch.nq == batch.nv || allFinite(reinterpret_cast<const S*>(one.pose), (poseSize(batch.shape) + lanes_of<S> - 1) / lanes_of<S>);
}

/// Coordinates of all joints but those that are alone, strip by strip in the lanes: component c of all items, four at a time. What is written
/// here is read in wider packs, and had better be there by then.
template <class S>
void gatherCoordinates(const CompactImpl& m, Workspace<S>& w, const double* q, const double* v) {
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const JointMemory<S>& memory = w.joints[b];
    if (!memory.q) continue;
    const TypeBatch& batch = m.batches[b];
    const StripBatch& strips = m.strips.batches[b];
    const auto gather = [&](const double* from, const std::vector<std::int64_t>& index, int size, S* to) {
      for (int c = 0; c < size; ++c)
        for (int k = 0; k < strips.slots; ++k) to[c * strips.slots + k] = gathered<S>(from + c, index.data() + strip_lanes * k);
    };
    gather(q, strips.q_index, batch.nq, memory.q);
    if (memory.v && v) gather(v, strips.v_index, batch.nv, memory.v);
  }
}

/// Poses, subspaces and (with v) biases of all joints. False if a type that normalises coordinates, as quaternions are, gave a pose that is
/// not finite.
template <class S>
bool evaluateStrips(const CompactImpl& m, StripScratch<S>& s, const double* q, const double* v) {
  bool finite = true;
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    JointMemory<S>& memory = s.w.joints[b];
    if (!memory.q) {
      finite = evaluateAlone(batch, s.alone[b], memory, q + batch.q_index[0], v ? v + batch.v_index[0] : nullptr) && finite;
    } else {
      ask<S>(*batch.fast, memory, nullptr, v != nullptr);
      finite = posesFinite(batch, memory) && finite;
    }
  }
  return finite;
}

/// Of flying roots the half below the diagonal, from what putFlying wrote.
inline void mirrorFlyingRoots(const CompactImpl& m, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (int i = 1; i < m.bodies(); i = m.tree_end[static_cast<std::size_t>(i)]) {
    const BodyIndex& root = m.index[static_cast<std::size_t>(i)];
    if (!root.flying_root) continue;
    const std::ptrdiff_t v = root.idx_v, end = m.dof_end[static_cast<std::size_t>(v)];
    std::ptrdiff_t j = v + 6;
    for (; j + 4 <= end; j += 4) {
      const double* const from = M + j * n + v;
      double* const to = M + v * n + j;
      Square<double, 4> square;
      square.read(from, n);
      square.transpose();
      square.write(to, n);
      const auto two = [&](int row) -> Square<double, 2>::Row { return *reinterpret_cast<const Square<double, 2>::Unaligned*>(from + row * n + 4); };
      const Four upper = __builtin_shufflevector(two(0), two(1), 0, 1, 2, 3), lower = __builtin_shufflevector(two(2), two(3), 0, 1, 2, 3);
      square.rows[0] = __builtin_shufflevector(upper, lower, 0, 2, 4, 6);
      square.rows[1] = __builtin_shufflevector(upper, lower, 1, 3, 5, 7);
      square.write(0, to + 4 * n);
      square.write(1, to + 5 * n);
    }
    for (; j < end; ++j)
      for (int c = 0; c < 6; ++c) M[(v + c) * n + j] = M[j * n + v + c];
  }
}

template <class S>
PackedKernels stripKernels() {
  PackedKernels k;
  k.over_strips = true;
  k.bytes = [](const CompactImpl& m) { return scratchBytes<StripScratch<S>>(m); };
  k.prepare = [](const CompactImpl& m, char* scratch) { makeScratch<StripScratch<S>>(scratch, m).w.R[0] = Mat3<S>::identity(); };
  k.rnea = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* a, double* tau) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    const Strips<S> strips{m, s.w};
    gatherCoordinates(m, s.w, q, v);
    gatherDofs(m.strips, v, s.v);
    gatherDofs(m.strips, a, s.a);
    const bool finite = evaluateStrips(m, s, q, v);
    rneaOutward(strips, s.w, s.v, s.a);
    rneaInward(strips, s.w, s.result);
    scatterDofs(m.strips, s.result, tau);
    addJointForces(m, v, a, tau);
    return finite;
  };
  k.massMatrix = [](const CompactImpl& m, char* scratch, const double* q, double* M) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    gatherCoordinates(m, s.w, q, nullptr);
    const bool finite = evaluateStrips(m, s, q, nullptr);
    kernels::massMatrix(Strips<S>{m, s.w}, s.w, M);
    mirrorFlyingRoots(m, M);
    return finite;
  };
  k.articulate = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* tau, int& failed) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    const Strips<S> strips{m, s.w};
    gatherCoordinates(m, s.w, q, v);
    gatherDofs(m.strips, v, s.v);
    gatherDofs(m.strips, tau, s.a);
    const bool finite = evaluateStrips(m, s, q, v);
    abaOutward(strips, s.w, s.v);
    abaInward(strips, s.w, s.a);
    failed = firstFailure(m, s.w);
    return finite;
  };
  k.accelerate = [](const CompactImpl& m, char* scratch, const Vec3<double>& gravity, double* ddq) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    abaSolve(Strips<S>{m, s.w}, s.w, cast<S>(gravity), s.result);
    scatterDofs(m.strips, s.result, ddq);
  };
  k.centroidalMap = [](const CompactImpl& m, char* scratch, const double* q, const double* v, double* Ag, CentroidalState<double>& out) {
    auto& s = *reinterpret_cast<StripScratch<S>*>(scratch);
    gatherCoordinates(m, s.w, q, nullptr);
    gatherDofs(m.strips, v, s.v);
    const bool finite = evaluateStrips(m, s, q, nullptr);
    out = fromLane<CentroidalState<double>, S>(kernels::centroidalMap(Strips<S>{m, s.w}, s.v, StripMap<S>{m, Ag}), 0);
    return finite;
  };
  return k;
}

}  // namespace dyn::kernels
