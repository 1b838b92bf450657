// The kernels of constraints of one table.
#pragma once

#include "kernels/constraint_table.hpp"
#include "kernels/strip_scratch.hpp"

namespace dyn::kernels {

/// One lane of a struct of packs.
template <class To, class S, class From>
void readLane(const From& from, int lane, To& to) {
  static_assert(sizeof(From) == sizeof(To) * static_cast<std::size_t>(lanes_of<S>));
  const auto* numbers = reinterpret_cast<const double*>(&from) + lane;
  auto* out = reinterpret_cast<double*>(&to);
  for (std::size_t k = 0; k < sizeof(To) / sizeof(double); ++k) out[k] = numbers[k * static_cast<std::size_t>(lanes_of<S>)];
}

/// S: the strips' packs.
template <class S>
void addStripConstraints(ConstraintKernels& k) {
  k.readBodies = [](const CompactImpl& m, const char* scratch, const PackedConstraints& c, Workspace<double>& w) {
    const Workspace<S>& from = reinterpret_cast<const StripScratch<S>*>(scratch)->w;
    for (const ConstrainedBody& b : c.bodies) {
      const int i = b.body;
      const BodyIndex& index = m.index[static_cast<std::size_t>(i)];
      const auto read = [&](const auto& packs, auto& to) { readLane<std::remove_reference_t<decltype(to)>, S>(packs, b.seat.lane, to); };
      read(from.R[b.seat.strip], w.R[i]);
      read(from.r[b.seat.strip], w.r[i]);
      read(from.w[b.seat.strip], w.w[i]);
      read(from.beta[b.seat.strip], w.beta[i]);
      if (index.flying_root) read(from.rel[b.seat.strip], w.rel[i]);
      for (int l = 0; l < index.nv; ++l) read(from.dof[b.seat.strip_dof + l], w.dof[index.idx_v + l]);
    }
  };
  k.writeShares = [](const Workspace<double>& w, const PackedConstraints& c, char* scratch) {
    Workspace<S>& to = reinterpret_cast<StripScratch<S>*>(scratch)->w;
    for (std::size_t b = 0; b < c.bodies.size(); ++b) {
      const ConstrainedBody& here = c.bodies[b];
      const int end = b + 1 < c.bodies.size() ? c.bodies[b + 1].dof : static_cast<int>(c.dofs.size());
      for (int l = here.dof; l < end; ++l)
        for (int lane = 0; lane < strip_lanes; ++lane)
          if (here.seat.lanes >> lane & 1) to.dof[here.seat.strip_dof + l - here.dof].y.begin()[lane] = w.dof[c.dofs[static_cast<std::size_t>(l)]].y;
    }
  };
}

/// Panel: what rows are worked on in, side by side.
template <class Panel>
ConstraintKernels singleConstraintKernels() {
  ConstraintKernels k{};
  k.layout = constraintLayoutStamp();
  k.sweep = kernels::constraintSweep<Panel>;
  k.delassusMatrix = kernels::delassusMatrix<Panel>;
  k.invertDelassus = kernels::invertDelassus<Panel>;
  k.timesRows = kernels::timesRows<Panel>;
  k.addForces = kernels::addConstraintForces<Panel>;
  k.accelerate = kernels::accelerateConstrained<Panel>;
  k.pointColumns = kernels::pointColumns;
  k.rowDerivatives = kernels::rowDerivatives<Panel>;
  k.invertConstrained = kernels::invertConstrained<Panel>;
  k.solveConstrained[0] = kernels::solveConstrained<Panel, 1>;
  k.solveConstrained[1] = kernels::solveConstrained<Panel, 2>;
  return k;
}

}  // namespace dyn::kernels
