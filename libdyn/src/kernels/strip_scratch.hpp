// Memory of the recursions over strips, and the way in and out of their lanes.
#pragma once

#include "kernels/lanes.hpp"
#include "kernels/workspace.hpp"

namespace dyn::kernels {

/// Scratch of a model's strips.
template <class S>
struct StripScratch {
  Workspace<S> w;
  JointMemory<double>* alone = nullptr;  ///< a batch each: joints that are the only one of their type, asked once for all lanes
  S *v, *a, *result;

  static std::size_t carve(StripScratch& s, const CompactImpl& m, char* base) {
    Arena arena(base);
    carve(s, m, arena);
    return arena.used();
  }
  static void carve(StripScratch& s, const CompactImpl& m, Arena& arena) {
    const StripPlan& plan = m.strips;
    arena.take(s.w.joints, m.batches.size());
    arena.take(s.alone, m.batches.size());
    JointMemory<S> counted;
    JointMemory<double> counted_alone;
    for (std::size_t b = 0; b < m.batches.size(); ++b) {
      const TypeBatch& batch = m.batches[b];
      const StripBatch& strips = plan.batches[b];
      JointMemory<S>& memory = s.w.joints ? s.w.joints[b] : counted;
      dyn::carve(memory, batch, strips.slots, batch.count > 1, arena);
      if (batch.count > 1) {
        // A strip's lanes are joints, each with constants of its own.
        prepareCall(memory, batch, strips.constants, strips.slots * strip_lanes, 1);
      } else {
        JointMemory<double>& one = s.alone ? s.alone[b] : counted_alone;
        dyn::carve(one, batch, 1, false, arena);
        prepareCall(one, batch, batch.constants, 1, 1);
      }
    }
    const auto dofs = static_cast<std::size_t>(plan.dofs);
    carveDynamics(s.w, plan.strips.size(), dofs, arena);
    arena.take(s.v, dofs);
    arena.take(s.a, dofs);
    arena.take(s.result, dofs);
  }
};

/// What it has been gathered to.
template <class S>
const S* gatherDofs(const StripPlan& plan, const double* from, S* to) {
  const std::int64_t* index = plan.dof_index.data();
  int k = 0;
  for (; k < plan.shared_dofs; ++k, index += strip_lanes) to[k] = S(from[*index]);
  for (; k < plan.dofs; ++k, index += strip_lanes) to[k] = gathered<S>(from, index);
  return to;
}

template <class S>
void scatterDofs(const StripPlan& plan, const S* from, double* to) {
  const auto* numbers = reinterpret_cast<const double*>(from);
  for (const std::int64_t place : plan.dof_place) *to++ = numbers[place];
}

/// The body whose pivot vanished, in the first lane where one did; or 0.
template <class S>
int firstFailure(const CompactImpl& m, const Workspace<S>& w) {
  for (int l = 0; l < strip_lanes; ++l)
    if (w.failed[l] != 0) return m.strips.strips[static_cast<std::size_t>(w.failed[l])].shown[l];
  return 0;
}

}  // namespace dyn::kernels
