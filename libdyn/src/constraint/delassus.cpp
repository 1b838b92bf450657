// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/kkt.hpp"
#include "constraint/solution.hpp"

#include <dyn/constraint/delassus.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

/// Runs the articulated-body recursion at rest, or factors M, and locates the rows. Afterwards no forces act on the degrees of freedom.
void prepare(const char* algorithm, const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  checkConstraints(algorithm, model, data, constraints);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q}, &c.block);
  if (!m.couplings.empty()) return projectInertia(algorithm, model, data, q, nullptr, c);
  const Inputs in = readInputs(algorithm, model, data, q, nullptr, nullptr);
  articulateBodies(algorithm, m, d, c, in.q, d.zero, d.zero, nullptr);
  std::copy_n(in.q, m.nqx, c.q);
  prepareRows(m, d, c, in.q, nullptr);
}

void form(const char* algorithm, const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  prepare(algorithm, model, data, q, constraints);
  if (model.impl().couplings.empty()) articulateRows(model.impl(), data.impl(), constraints.impl());
}

}  // namespace

const double* delassusMatrix(const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  form("computeDelassusMatrix", model, data, q, constraints);
  ConstraintDataImpl& c = constraints.impl();
  const std::ptrdiff_t rows = c.set.rows();
  for (std::ptrdiff_t r = 0; r < rows; ++r) std::copy_n(c.workspace.delassus + c.workspace.stride * r, rows, c.matrix + rows * r);
  return c.matrix;
}

const double* operationalSpaceInertia(const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  form("computeOperationalSpaceInertia", model, data, q, constraints);
  ConstraintDataImpl& c = constraints.impl();
  const std::ptrdiff_t rows = c.set.rows();
  c.solver.factor(c.workspace, constraints.settings);
  std::fill_n(c.wanted, rows, 0.0);
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    c.wanted[r] = 1;
    c.solver.solve(c.wanted, c.step);
    c.wanted[r] = 0;
    std::copy_n(c.step, rows, c.matrix + rows * r);
  }
  return c.matrix;
}

void prepareDelassus(const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  prepare("DelassusOperator", model, data, q, constraints);
}

void applyDelassus(const CompactModel& model, Data& data, ConstraintData& constraints, VectorView x, const VectorOut& out) {
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  const PackedConstraints& packed = c.set.impl();
  checkSize("DelassusOperator", "x", x, packed.rows);
  checkSize("DelassusOperator", "out", {out.data(), out.size()}, packed.rows);
  if (!m.couplings.empty()) {
    std::fill_n(c.v_after, m.nv, 0.0);
    for (int k = 0; k < m.nv; ++k)
      for (int r = 0; r < packed.rows; ++r) c.v_after[k] += c.J[static_cast<std::ptrdiff_t>(packed.rows) * k + r] * x.data[r];
    solveInertia(model, data, c.v_after);
    std::fill_n(out.data(), packed.rows, 0.0);
    addRowsOf(m, c, c.v_after, out.data());
    return;
  }
  // One force for each body goes to the world; each degree of freedom responds to its projection.
  const PlacedBodies bodies = placedBodies(d, c);
  sumRowForces(m, packed, c.frames, c.q, x.data, c.total, c.projections);
  bodies.run.respondTo(m, bodies.memory, packed, c.total, c.projections);
  accelerateBodies(m, d, c, {}, c.expanded);
  bodies.run.takeAccelerations(m, bodies.memory, packed, c.workspace);
  rowAccelerations(m, packed, c.frames, c.q, c.workspace, c.expanded, c.gamma);
  std::copy_n(c.gamma, packed.rows, out.data());
  bodies.run.forgetForces(m, bodies.memory, packed);
}

}  // namespace dyn::detail
