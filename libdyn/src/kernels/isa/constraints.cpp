// SPDX-License-Identifier: BSD-2-Clause
// Constraint kernels of one table.
#include "kernels/constraint/constrained_inverse.hpp"
#include "kernels/constraint/constraint_recursions.hpp"
#include "kernels/constraint/delassus.hpp"
#include "kernels/constraint/frame_rows.hpp"
#include "kernels/isa/constraint_states.hpp"
#include "kernels/isa/constraint_table.hpp"
#include "kernels/isa/table_parts.hpp"
#include "kernels/order/lane_group_scratch.hpp"

namespace dyn::kernels {

namespace {

template <class S>
ConstrainedBodies<S> bodiesIn(const CompactImpl& m, void* memory) {
  if constexpr (lanes_of<S> == 1) {
    return {m, *static_cast<Workspace<S>*>(memory)};
  } else {
    return {m, static_cast<LaneGroupScratch<S>*>(memory)->w};
  }
}

/// S is the scalar of the bodies: a number, or a pack of joints for lane groups.
template <class S>
constexpr ConstraintRecursions constraintRecursions() {
  ConstraintRecursions k{};
  k.locate = [](const CompactImpl& m, void* memory, const PackedConstraints& c, const double* v, RowRates rates, ConstraintWorkspace& x) {
    locateChains(bodiesIn<S>(m, memory), c, v, rates, x);
  };
  k.sweep = [](const CompactImpl& m, void* memory, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
    constraintSweep<WidestPack, Wide>(bodiesIn<S>(m, memory), c, eliminated, x);
  };
  k.respondTo = [](const CompactImpl& m, void* memory, const PackedConstraints& c, Force<double>* F, const double* projections) {
    projectOutOfForces(bodiesIn<S>(m, memory), c, F, projections);
  };
  k.takeResponse = [](const CompactImpl& m, void* memory, const PackedConstraints& c, const ConstraintWorkspace& x) {
    takeResponse(bodiesIn<S>(m, memory), c, x);
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
  k.states = constraintStates<Doubles>();
  k.placeFrames = kernels::placeFrames<Wide>;
  k.frameAccelerations = kernels::frameAccelerations<Wide>;
  k.delassusMatrix = kernels::delassusMatrix<WidestPack, Wide>;
  k.respondToRows = kernels::respondToRows<WidestPack, Wide>;
  k.rowsOfResponse = kernels::rowsOfResponse<WidestPack, Wide>;
  k.invertDelassus = kernels::invertDelassus<WidestPack, Wide>;
  k.timesRows = kernels::timesRows<WidestPack, Wide>;
  k.pointColumns = kernels::pointColumns;
  k.rowDerivatives = kernels::rowDerivatives<WidestPack>;
  k.invertConstrained = kernels::invertConstrained<WidestPack>;
  k.solveConstrained[0] = kernels::solveConstrained<WidestPack, 1>;
  k.solveConstrained[1] = kernels::solveConstrained<WidestPack, 2>;
#if DYN_JOINTS_IN_LANES
  k.lane_groups = constraintRecursions<Wide>();
#endif
  return k;
}

}  // namespace

const ConstraintKernels& tableConstraints() {
  static const ConstraintKernels k = makeConstraintKernels();
  return k;
}

}  // namespace dyn::kernels
