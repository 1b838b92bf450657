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
    const std::size_t n = plan.strips.size();
    arena.take(s.w.rel, n);
    arena.take(s.w.a, n);
    arena.take(s.w.w, n);
    arena.take(s.w.f, n);
    arena.take(s.w.R, n);
    arena.take(s.w.r, n);
    arena.take(s.w.beta, n);
    arena.take(s.w.IA, n);
    arena.take(s.w.pA, n);
    arena.take(s.w.acc, n);
    arena.take(s.w.h, n);
    arena.take(s.w.Io, n);
    arena.take(s.w.mass, n);
    const auto dofs = static_cast<std::size_t>(plan.dofs);
    arena.take(s.w.dof, dofs);
    arena.take(s.v, dofs);
    arena.take(s.a, dofs);
    arena.take(s.result, dofs);
    return arena.used();
  }
};

}  // namespace dyn::kernels
