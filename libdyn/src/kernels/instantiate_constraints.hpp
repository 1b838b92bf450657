// The kernels of constraints of one table.
#pragma once

#include "kernels/constrained_inverse.hpp"
#include "kernels/constraint_recursions.hpp"
#include "kernels/constraint_table.hpp"
#include "kernels/delassus.hpp"
#include "kernels/frame_rows.hpp"
#include "kernels/strip_scratch.hpp"

namespace dyn::kernels {

template <class S>
ConstrainedBodies<S> bodiesIn(const CompactImpl& m, void* memory) {
  if constexpr (lanes_of<S> == 1) {
    return {m, *static_cast<Workspace<S>*>(memory)};
  } else {
    return {m, static_cast<StripScratch<S>*>(memory)->w};
  }
}

/// Panel: what rows are worked on in, side by side, and Half where there are few; S: what bodies are in.
template <class Panel, class Half, class S>
constexpr ConstraintRecursions constraintRecursions() {
  ConstraintRecursions k{};
  k.locate = [](const CompactImpl& m, void* memory, const PackedConstraints& c, const double* v, RowRates rates, ConstraintWorkspace& x) {
    locateChains(bodiesIn<S>(m, memory), c, v, rates, x);
  };
  k.sweep = [](const CompactImpl& m, void* memory, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
    constraintSweep<Panel, Half>(bodiesIn<S>(m, memory), c, eliminated, x);
  };
  k.yieldTo = [](const CompactImpl& m, void* memory, const PackedConstraints& c, Force<double>* F, const double* shares) {
    yieldToForces(bodiesIn<S>(m, memory), c, F, shares);
  };
  k.takeYielded = [](const CompactImpl& m, void* memory, const PackedConstraints& c, const ConstraintWorkspace& x) {
    takeYielded(bodiesIn<S>(m, memory), c, x);
  };
  k.takeAccelerations = [](const CompactImpl& m, void* memory, const PackedConstraints& c, ConstraintWorkspace& x) {
    takeAccelerations(bodiesIn<S>(m, memory), c, x);
  };
  k.forgetForces = [](const CompactImpl& m, void* memory, const PackedConstraints& c) { forgetForces(bodiesIn<S>(m, memory), c); };
  return k;
}

template <class Panel, class Half>
ConstraintKernels singleConstraintKernels() {
  ConstraintKernels k{};
  k.layout = constraintLayoutStamp();
  k.single = constraintRecursions<Panel, Half, double>();
  k.placeFrames = kernels::placeFrames<Half>;
  k.frameAccelerations = kernels::frameAccelerations<Half>;
  k.delassusMatrix = kernels::delassusMatrix<Panel, Half>;
  k.yieldToRows = kernels::yieldToRows<Panel, Half>;
  k.rowsOfYielded = kernels::rowsOfYielded<Panel, Half>;
  k.invertDelassus = kernels::invertDelassus<Panel, Half>;
  k.timesRows = kernels::timesRows<Panel, Half>;
  k.pointColumns = kernels::pointColumns;
  k.rowDerivatives = kernels::rowDerivatives<Panel>;
  k.invertConstrained = kernels::invertConstrained<Panel>;
  k.solveConstrained[0] = kernels::solveConstrained<Panel, 1>;
  k.solveConstrained[1] = kernels::solveConstrained<Panel, 2>;
  return k;
}

}  // namespace dyn::kernels
