// SPDX-License-Identifier: BSD-2-Clause
// Recursions over lane groups: the kernels for bodies, with four joints in the lanes of a pack.
//
// A second implementation of an algorithm stays only if it is 15 % faster on two robots. With CompileOptions::lane_groups = false, recursions visit
// one body after the other and take longer by these factors (AVX-512, single states). HyQ and ANYmal: 1.46 and 1.47 for rnea, 1.41 and 1.37 for aba,
// 1.42 and 1.48 for crba, 1.26 and 1.30 for minverse, 1.27 and 1.30 for the derivatives of rnea, 1.20 and 1.25 for ccrba. TALOS: 1.33 for rnea, 1.13
// for aba and 1.04 for the derivatives.
#pragma once

#include "kernels/body/dissipation.hpp"
#include "kernels/body/evaluate.hpp"
#include "kernels/body/scratch.hpp"
#include "kernels/isa/lane_group_map.hpp"
#include "kernels/order/lane_group_scratch.hpp"
#include "kernels/order/lane_groups.hpp"
#include "kernels/recursion/aba.hpp"
#include "kernels/recursion/crba.hpp"
#include "kernels/recursion/rnea.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

/// Evaluates the only joint of its type, most often a floating base, once and copies the results to all lanes. Returns false like posesFinite().
template <class S>
bool evaluateAlone(const TypeBatch& batch, JointMemory<double>& one, const JointMemory<S>& lanes, const double* q, const double* v) {
  if (one.v && v) std::copy_n(v, batch.nv, one.v);
  evaluateBatch(*batch.fast, one, q, v != nullptr);
  const auto spread = [](const double* from, int count, S* to) {
    for (int k = 0; k < count; ++k) to[k] = S(from[k]);
  };
  spread(one.pose, poseSize(batch.shape), lanes.pose);
  if (one.subspace) spread(one.subspace, 6 * batch.nv, lanes.subspace);
  if (one.bias && v) spread(one.bias, 6, lanes.bias);
  // Reads the pose in packs, which is possible because zeros follow it.
  return batch.nq == batch.nv || allFinite(reinterpret_cast<const S*>(one.pose), (poseSize(batch.shape) + lanes_of<S> - 1) / lanes_of<S>);
}

/// Gathers the coordinates of all joints that are not the only one of their type into lanes: component c of all lane groups of a batch, four joints
/// at a time. The types read in wider packs what is written here, so all batches are gathered before the first evaluation.
template <class S>
void gatherCoordinates(const CompactImpl& m, Workspace<S>& w, const double* q, const double* v) {
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const JointMemory<S>& memory = w.joints[b];
    if (!memory.q) continue;
    const TypeBatch& batch = m.batches[b];
    const LaneGroupBatch& lane_groups = m.lane_groups.batches[b];
    const auto gather = [&](const double* from, const std::vector<std::int64_t>& index, int size, S* to) {
      for (int c = 0; c < size; ++c)
        for (int k = 0; k < lane_groups.slots; ++k) to[c * lane_groups.slots + k] = gathered<S>(from + c, index.data() + group_lanes * k);
    };
    gather(q, lane_groups.q_index, batch.nq, memory.q);
    if (memory.v && v) gather(v, lane_groups.v_index, batch.nv, memory.v);
  }
}

/// Computes poses, subspaces and (with v) biases of all joints. Returns false if a type that normalises coordinates, such as quaternions, gave a pose
/// that is not finite.
template <class S>
bool evaluateLaneGroups(const CompactImpl& m, LaneGroupScratch<S>& s, const double* q, const double* v) {
  bool finite = true;
  for (std::size_t b = 0; b < m.batches.size(); ++b) {
    const TypeBatch& batch = m.batches[b];
    JointMemory<S>& memory = s.w.joints[b];
    if (!memory.q) {
      finite = evaluateAlone(batch, s.alone[b], memory, q + batch.q_index[0], v ? v + batch.v_index[0] : nullptr) && finite;
    } else {
      evaluateBatch<S>(*batch.fast, memory, nullptr, v != nullptr);
      finite = posesFinite(batch, memory) && finite;
    }
  }
  return finite;
}

/// Copies the rows of floating bases, which enterFloatingBase() wrote above the diagonal of M, to their columns below it.
inline void mirrorFloatingBases(const CompactImpl& m, double* M) {
  const std::ptrdiff_t n = m.nvx;
  for (int i = 1; i < m.bodies(); i = m.tree_end[static_cast<std::size_t>(i)]) {
    const BodyIndex& root = m.index[static_cast<std::size_t>(i)];
    if (!root.floating_base) continue;
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
      const Vec4d upper = __builtin_shufflevector(two(0), two(1), 0, 1, 2, 3), lower = __builtin_shufflevector(two(2), two(3), 0, 1, 2, 3);
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
PackedKernels laneGroupKernels() {
  PackedKernels k;
  k.over_lane_groups = true;
  k.bytes = [](const CompactImpl& m) { return scratchBytes<LaneGroupScratch<S>>(m); };
  k.prepare = [](const CompactImpl& m, char* scratch) { makeScratch<LaneGroupScratch<S>>(scratch, m).w.R[0] = Mat3<S>::identity(); };
  k.rnea = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* a, double* tau) {
    auto& s = *reinterpret_cast<LaneGroupScratch<S>*>(scratch);
    const LaneGroups<S> lane_groups{m, s.w};
    gatherCoordinates(m, s.w, q, v);
    gatherDofs(m.lane_groups, v, s.v);
    gatherDofs(m.lane_groups, a, s.a);
    const bool finite = evaluateLaneGroups(m, s, q, v);
    rneaOutward(lane_groups, s.w, s.v, s.a);
    rneaInward(lane_groups, s.w, s.result);
    scatterDofs(m.lane_groups, s.result, tau);
    addJointForces(m, v, a, tau);
    return finite;
  };
  k.massMatrix = [](const CompactImpl& m, char* scratch, const double* q, double* M) {
    auto& s = *reinterpret_cast<LaneGroupScratch<S>*>(scratch);
    gatherCoordinates(m, s.w, q, nullptr);
    const bool finite = evaluateLaneGroups(m, s, q, nullptr);
    kernels::massMatrix(LaneGroups<S>{m, s.w}, s.w, M);
    mirrorFloatingBases(m, M);
    return finite;
  };
  k.articulate = [](const CompactImpl& m, char* scratch, const double* q, const double* v, const double* tau, int& failed) {
    auto& s = *reinterpret_cast<LaneGroupScratch<S>*>(scratch);
    const LaneGroups<S> lane_groups{m, s.w};
    gatherCoordinates(m, s.w, q, v);
    gatherDofs(m.lane_groups, v, s.v);
    gatherDofs(m.lane_groups, tau, s.a);
    const bool finite = evaluateLaneGroups(m, s, q, v);
    abaOutward(lane_groups, s.w, s.v);
    abaInward(lane_groups, s.w, s.a);
    failed = firstFailure(m, s.w);
    return finite;
  };
  k.accelerate = [](const CompactImpl& m, char* scratch, const Vec3<double>& gravity, double* ddq) {
    auto& s = *reinterpret_cast<LaneGroupScratch<S>*>(scratch);
    abaSolve(LaneGroups<S>{m, s.w}, s.w, cast<S>(gravity), s.result);
    scatterDofs(m.lane_groups, s.result, ddq);
  };
  k.centroidalMap = [](const CompactImpl& m, char* scratch, const double* q, const double* v, double* Ag, CentroidalState<double>& out) {
    auto& s = *reinterpret_cast<LaneGroupScratch<S>*>(scratch);
    gatherCoordinates(m, s.w, q, nullptr);
    gatherDofs(m.lane_groups, v, s.v);
    const bool finite = evaluateLaneGroups(m, s, q, nullptr);
    out = fromLane<CentroidalState<double>, S>(kernels::centroidalMap(LaneGroups<S>{m, s.w}, s.v, LaneGroupMap<S>{m, Ag}), 0);
    return finite;
  };
  return k;
}

}  // namespace dyn::kernels
