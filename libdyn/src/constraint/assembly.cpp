// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/kkt.hpp"
#include "constraint/solution.hpp"
#include "kernels/isa/constraint_table.hpp"
#include "number_text.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/constraint/assembly.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace dyn::detail {

namespace {

/// Computes all that a step needs at configuration q. Returns the largest error, or infinity if an error is NaN.
double prepareStep(const CompactModel& model, Data& data, VectorView q, ConstraintDataImpl& c) {
  const char* algorithm = "projectConfiguration";
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  if (m.couplings.empty()) {
    const Inputs in = readInputs(algorithm, model, data, q, nullptr, nullptr);
    articulateBodies(algorithm, m, d, c, in.q, d.zero, d.zero, nullptr);
    prepareRows(m, d, c, in.q, nullptr);
    articulateRows(m, d, c);
  } else {
    projectInertia(algorithm, model, data, q, nullptr, c);
  }
  double largest = 0;
  for (int r = 0; r < c.set.rows(); ++r)
    if (!(std::abs(c.motion.error[r]) <= largest)) largest = std::isnan(c.motion.error[r]) ? HUGE_VAL : std::abs(c.motion.error[r]);
  return largest;
}

/// Writes M^-1 J^T lambda to d.ddq.
void motionOfForces(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c) {
  if (m.couplings.empty()) {
    actOnBodies(m, d, c, c.lambda);
    accelerateBodies(m, d, c, {}, d.ddq);
  } else {
    std::fill_n(d.ddq, m.nv, 0.0);
    addMotionOf(m, c, c.lambda, d.ddq);
  }
}

}  // namespace

AssemblyViews projectConfiguration(const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints,
                                   const AssemblySettings& settings) {
  checkConstraints("projectConfiguration", model, data, constraints);
  checkSize("projectConfiguration", "q", q, model.nq());
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  double *here = c.q, *next = c.q + m.nq, *step = c.v_after;
  std::copy_n(q.data, m.nq, here);
  double error = prepareStep(model, data, {here, m.nq}, c);
  int iterations = 0;
  while (error > 0 && iterations < settings.max_iterations) {
    ++iterations;
    c.solver.factor(c.workspace, constraints.settings);
    for (int r = 0; r < c.set.rows(); ++r) c.wanted[r] = -c.motion.error[r];
    c.solver.solve(c.wanted, c.lambda);
    motionOfForces(m, d, c);
    std::copy_n(d.ddq, m.nv, step);
    double share = 1, after = HUGE_VAL;
    for (int halved = 0; halved < 12 && !(after < error); ++halved, share /= 2) {
      for (int k = 0; k < m.nv; ++k) d.ddq[k] = share * step[k];
      integrate(model, VectorView{here, m.nq}, VectorView{d.ddq, m.nv}, VectorOut(next, m.nq));
      after = prepareStep(model, data, {next, m.nq}, c);
    }
    if (!(after < error)) break;
    std::swap(here, next);
    error = after;
  }
  return {here, error, error <= settings.tolerance, iterations};
}

void assemble(const CompactModel& model, Data& data, const VectorOut& q, ConstraintData& constraints, const AssemblySettings& settings) {
  const AssemblyViews found = projectConfiguration(model, data, VectorView{q.data(), q.size()}, constraints, settings);
  if (found.closed) {
    std::copy_n(found.q, model.nq(), q.data());
    return;
  }
  ConstraintDataImpl& c = constraints.impl();
  prepareStep(model, data, {found.q, model.nq()}, c);
  int worst = 0;
  for (int r = 1; r < c.set.rows(); ++r)
    if (std::abs(c.motion.error[r]) > std::abs(c.motion.error[worst])) worst = r;
  int constraint = 0;
  while (c.set.firstRow(constraint) + c.set.rows(constraint) <= worst) ++constraint;
  throw Error(ErrorCode::closure, "assemble: constraint '" + c.set.description(constraint).name + "' cannot be closed from here: an error of " +
                                      number(found.error) + " is left after " + std::to_string(found.iterations) +
                                      " steps; start from a guess nearer to the closed mechanism");
}

}  // namespace dyn::detail
