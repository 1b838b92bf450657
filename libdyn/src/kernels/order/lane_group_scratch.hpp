// SPDX-License-Identifier: BSD-2-Clause
// Memory of the recursions over lane groups. Coordinates are gathered into lanes, and results are scattered back.
#pragma once

#include "kernels/body/workspace.hpp"
#include "kernels/pack/lanes.hpp"

namespace dyn::kernels {

/// Scratch of the recursions over a model's lane groups.
template <class S>
struct LaneGroupScratch {
  Workspace<S> w;
  JointMemory<double>* alone = nullptr;  ///< one per batch: a joint that is the only one of its type is evaluated once for all lanes
  S *v, *a, *result;

  static std::size_t layOut(LaneGroupScratch& s, const CompactImpl& m, char* base) {
    Arena arena(base);
    layOut(s, m, arena);
    return arena.used();
  }
  static void layOut(LaneGroupScratch& s, const CompactImpl& m, Arena& arena) {
    const LaneGroupPlan& plan = m.lane_groups;
    arena.take(s.w.joints, m.batches.size());
    arena.take(s.alone, m.batches.size());
    JointMemory<S> counted;
    JointMemory<double> counted_alone;
    for (std::size_t b = 0; b < m.batches.size(); ++b) {
      const TypeBatch& batch = m.batches[b];
      const LaneGroupBatch& lane_groups = plan.batches[b];
      JointMemory<S>& memory = s.w.joints ? s.w.joints[b] : counted;
      dyn::layOut(memory, batch, lane_groups.slots, batch.count > 1, arena);
      if (batch.count > 1) {
        // The lanes of a lane group are joints, each with its own constants.
        prepareCall(memory, batch, lane_groups.constants, lane_groups.slots * group_lanes, 1);
      } else {
        JointMemory<double>& one = s.alone ? s.alone[b] : counted_alone;
        dyn::layOut(one, batch, 1, false, arena);
        prepareCall(one, batch, batch.constants, 1, 1);
      }
    }
    const auto dofs = static_cast<std::size_t>(plan.dofs);
    layOutDynamics(s.w, plan.lane_groups.size(), dofs, arena);
    arena.take(s.v, dofs);
    arena.take(s.a, dofs);
    arena.take(s.result, dofs);
  }
};

/// Gathers one number per degree of freedom into the lanes. Returns `to`.
template <class S>
const S* gatherDofs(const LaneGroupPlan& plan, const double* from, S* to) {
  const std::int64_t* index = plan.dof_index.data();
  int k = 0;
  for (; k < plan.shared_dofs; ++k, index += group_lanes) to[k] = S(from[*index]);
  for (; k < plan.dofs; ++k, index += group_lanes) to[k] = gathered<S>(from, index);
  return to;
}

template <class S>
void scatterDofs(const LaneGroupPlan& plan, const S* from, double* to) {
  const auto* numbers = reinterpret_cast<const double*>(from);
  for (const std::int64_t place : plan.dof_place) *to++ = numbers[place];
}

/// The body whose pivot vanished, from the first lane that noted one; 0 if there is none.
template <class S>
int firstFailure(const CompactImpl& m, const Workspace<S>& w) {
  for (int l = 0; l < group_lanes; ++l)
    if (w.failed[l] != 0) return m.lane_groups.lane_groups[static_cast<std::size_t>(w.failed[l])].shows[l];
  return 0;
}

}  // namespace dyn::kernels
