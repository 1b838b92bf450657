// Memory of the recursions over strips.
#pragma once

#include "kernels/workspace.hpp"

namespace dyn::kernels {

/// Scratch of a model's strips.
template <class S>
struct StripScratch {
  Workspace<S> w;
  S *v, *a, *result;

  static std::size_t carve(StripScratch& s, const CompactImpl& m, char* base) {
    const StripPlan& plan = m.strips;
    Arena arena(base);
    arena.take(s.w.joints, m.batches.size());
    JointMemory<S> counted;
    for (std::size_t b = 0; b < m.batches.size(); ++b)
      dyn::carve(s.w.joints ? s.w.joints[b] : counted, m.batches[b], plan.batches[b].slots, true, arena);
    const auto dofs = static_cast<std::size_t>(plan.dofs);
    carveDynamics(s.w, plan.strips.size(), dofs, arena);
    arena.take(s.v, dofs);
    arena.take(s.a, dofs);
    arena.take(s.result, dofs);
    return arena.used();
  }
};

}  // namespace dyn::kernels
