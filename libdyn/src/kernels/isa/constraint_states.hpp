// SPDX-License-Identifier: BSD-2-Clause
// Constraints of blocks of states, one state a lane: the recursions of constraints between the passes of the articulated-body recursion.
#pragma once

#include "kernels/body/scratch.hpp"
#include "kernels/constraint/constraint_recursions.hpp"
#include "kernels/constraint/delassus.hpp"
#include "kernels/constraint/frame_rows.hpp"
#include "kernels/isa/block.hpp"
#include "kernels/isa/constraint_table.hpp"
#include "kernels/pack/columns.hpp"
#include "kernels/recursion/aba.hpp"

namespace dyn::kernels {

/// Scratch of one thread for the constraints of a block.
template <class S>
struct ConstraintStates {
  Workspace<S> aligned;  ///< the constraints' bodies as abaInward leaves them
  BasicConstraintWorkspace<S> x;
  BasicFrameRows<S>* frames = nullptr;
  BasicRowMotion<S> motion{};
  S *forces = nullptr, *gamma = nullptr, *wanted = nullptr;
  S* irregular = nullptr;  ///< one pack

  static std::size_t layOut(ConstraintStates& s, const CompactImpl& m, const PackedConstraints* c, char* base) {
    Arena arena(base);
    const auto bodies = static_cast<std::size_t>(m.bodies());
    arena.take(s.aligned.w, bodies);
    arena.take(s.aligned.beta, bodies);
    arena.take(s.aligned.dof, static_cast<std::size_t>(m.nvx));
    kernels::layOut(s.x, *c, arena);
    arena.take(s.frames, c->frames.size());
    for (S** vector : {&s.motion.bias, &s.motion.drift, &s.motion.fall, &s.motion.velocity, &s.motion.error, &s.forces, &s.gamma, &s.wanted})
      arena.take(*vector, static_cast<std::size_t>(s.x.room));
    arena.take(s.irregular, 1);
    return arena.used();
  }
  RowsOfStates rows() const {
    const auto numbers = [](S* packs) { return reinterpret_cast<double*>(packs); };
    return {{numbers(motion.bias), numbers(motion.drift), numbers(motion.fall), numbers(motion.velocity), numbers(motion.error)},
            numbers(x.projection),
            numbers(x.carried),
            numbers(x.bound),
            numbers(x.delassus),
            numbers(forces),
            numbers(gamma),
            numbers(wanted),
            numbers(irregular),
            x.stride,
            x.room};
  }
};

/// Turns what localAbaInward has left at the constraints' bodies into aligned axes. The bodies' axes and columns are in w already.
template <class S>
void alignBodies(const CompactImpl& m, const PackedConstraints& c, const Workspace<S>& w, Workspace<S>& aligned) {
  aligned.R = w.R;
  aligned.r = w.r;
  aligned.rel = w.rel;
  for (const ConstrainedBody& here : c.bodies) {
    const int i = here.body;
    const BodyIndex& index = m.index[static_cast<std::size_t>(i)];
    const Mat3<S>& R = w.R[i];
    aligned.w[i] = R * w.w[i];
    aligned.beta[i] = {R * w.beta[i].linear, R * w.beta[i].angular};
    const int last = index.idx_v + index.nv - 1;
    for (int k = index.idx_v; k <= last; ++k) {
      const DofFactor<S>& own = w.dof[k];
      aligned.dof[k] = {own.column, {R * own.W.linear, R * own.W.angular}, own.inverse, own.y};
      if (k == last) solveFromParent(aligned, i, aligned.dof[k]);
    }
  }
}

template <class S>
ConstraintStates<S>& statesIn(char* memory) {
  return *reinterpret_cast<ConstraintStates<S>*>(memory);
}

template <class S>
constexpr ConstraintStateKernels constraintStates() {
  using Scratch = ConstraintStates<S>;
  ConstraintStateKernels k{};
  k.bytes = [](const CompactImpl& m, const PackedConstraints& c) { return scratchBytes<Scratch>(m, &c); };
  k.prepare = [](const CompactImpl& m, const PackedConstraints& c, char* memory) { return makeScratch<Scratch>(memory, m, &c).rows(); };
  k.articulate = [](const CompactImpl& m, char* scratch, const PackedConstraints& c, const ColumnsIn<double>& v, RowRates rates, Block<double>& block,
                    char* memory) {
    auto& s = *reinterpret_cast<BlockScratch<S>*>(scratch);
    Scratch& own = statesIn<S>(memory);
    articulateStates(m, s, block);
    alignBodies(m, c, s.w, own.aligned);
    if (rates == RowRates::velocities) loadColumns(v, m.nvx, s.v);
    locateChains(ConstrainedBodies<S, S>{m, own.aligned}, c, s.v, rates, own.x);
    placeFrames<S>(m, c, rates, own.frames, own.motion, own.x);
    if (c.actsOnJoints()) std::fill_n(own.x.projection, own.x.room * static_cast<std::ptrdiff_t>(c.dofs.size()), S(0));
  };
  k.sweep = [](const CompactImpl& m, const PackedConstraints& c, char* memory) {
    Scratch& own = statesIn<S>(memory);
    constraintSweep<S, S>(ConstrainedBodies<S, S>{m, own.aligned}, c, true, own.x);
    delassusMatrix<S, S>(c, own.x);
    rowsOfResponse<S, S>(c, own.x, own.gamma);
  };
  k.invert = [](const PackedConstraints& c, double tolerance, char* memory) {
    Scratch& own = statesIn<S>(memory);
    *own.irregular = S(0);
    exchangeAllRows<S, S>(c.rows, own.x, 0.0, LeastPivots<S>{own.x.bound, tolerance, *own.irregular});
  };
  k.solve = [](const PackedConstraints& c, char* memory) {
    Scratch& own = statesIn<S>(memory);
    timesRows<S, S>(c.rows, own.x.stride, own.x.inverse, own.wanted, own.forces);
  };
  k.respondToRows = [](const PackedConstraints& c, char* memory) {
    Scratch& own = statesIn<S>(memory);
    respondToRows<S, S>(c, own.forces, own.x);
  };
  k.rowsOfResponse = [](const PackedConstraints& c, char* memory) {
    Scratch& own = statesIn<S>(memory);
    rowsOfResponse<S, S>(c, own.x, own.gamma);
  };
  k.accelerate = [](const CompactImpl& m, char* scratch, const PackedConstraints& c, const Vec3<double>& gravity, Block<double>& block,
                    char* memory) {
    auto& s = *reinterpret_cast<BlockScratch<S>*>(scratch);
    Scratch& own = statesIn<S>(memory);
    for (std::size_t place = 0; place < c.dofs.size(); ++place) {
      const int dof = c.dofs[place];
      s.w.dof[dof].y += own.x.response[place] - own.aligned.dof[dof].y;
    }
    accelerateStates(m, s, gravity, block);
  };
  return k;
}

}  // namespace dyn::kernels
