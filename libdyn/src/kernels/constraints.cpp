// The kernels of constraints of one table.
#include "kernels/constrained_inverse.hpp"
#include "kernels/constraint_recursions.hpp"
#include "kernels/constraint_table.hpp"
#include "kernels/delassus.hpp"
#include "kernels/frame_rows.hpp"
#include "kernels/strip_scratch.hpp"
#include "kernels/table_parts.hpp"

namespace dyn::kernels {

namespace {

template <class S>
ConstrainedBodies<S> bodiesIn(const CompactImpl& m, void* memory) {
  if constexpr (lanes_of<S> == 1) {
    return {m, *static_cast<Workspace<S>*>(memory)};
  } else {
    return {m, static_cast<StripScratch<S>*>(memory)->w};
  }
}

/// S: the scalar of the bodies.
template <class S>
constexpr ConstraintRecursions constraintRecursions() {
  ConstraintRecursions k{};
  k.locate = [](const CompactImpl& m, void* memory, const PackedConstraints& c, const double* v, RowRates rates, ConstraintWorkspace& x) {
    locateChains(bodiesIn<S>(m, memory), c, v, rates, x);
  };
  k.sweep = [](const CompactImpl& m, void* memory, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
    constraintSweep<Panel, Wide>(bodiesIn<S>(m, memory), c, eliminated, x);
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

ConstraintKernels makeConstraintKernels() {
  ConstraintKernels k{};
  k.layout = constraintLayoutStamp();
  k.single = constraintRecursions<double>();
  k.placeFrames = kernels::placeFrames<Wide>;
  k.frameAccelerations = kernels::frameAccelerations<Wide>;
  k.delassusMatrix = kernels::delassusMatrix<Panel, Wide>;
  k.yieldToRows = kernels::yieldToRows<Panel, Wide>;
  k.rowsOfYielded = kernels::rowsOfYielded<Panel, Wide>;
  k.invertDelassus = kernels::invertDelassus<Panel, Wide>;
  k.timesRows = kernels::timesRows<Panel, Wide>;
  k.pointColumns = kernels::pointColumns;
  k.rowDerivatives = kernels::rowDerivatives<Panel>;
  k.invertConstrained = kernels::invertConstrained<Panel>;
  k.solveConstrained[0] = kernels::solveConstrained<Panel, 1>;
  k.solveConstrained[1] = kernels::solveConstrained<Panel, 2>;
#if DYN_JOINTS_IN_LANES
  k.strips = constraintRecursions<Wide>();
#endif
  return k;
}

}  // namespace

const ConstraintKernels& tableConstraints() {
  static const ConstraintKernels k = makeConstraintKernels();
  return k;
}

}  // namespace dyn::kernels
