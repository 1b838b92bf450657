// SPDX-License-Identifier: BSD-2-Clause
#include "constraint/kkt.hpp"
#include "constraint/solution.hpp"

#include <dyn/algorithm/aba.hpp>
#include <dyn/constraint/dynamics.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::detail {

namespace {

/// Solves for lambda with the factors in c.solver and returns it with the residual of the wanted motion.
ConstrainedViews solved(ConstraintDataImpl& c, const double* motion) {
  const int iterations = c.solver.solve(c.wanted, c.lambda);
  return {motion, c.lambda, c.solver.residual(c.lambda, c.wanted, c.left), c.solver.rank(), iterations};
}

/// Solves for the forces c.lambda, corrects them once, and computes the accelerations from the last articulateBodies. The correction recovers digits
/// that the entries of the Delassus matrix have lost, but the projections still have. wantedOf(row): the wanted acceleration of the row, to be
/// produced by the response of the degrees of freedom.
template <class Wanted>
ConstrainedViews refined(const CompactImpl& m, DataImpl& d, ConstraintDataImpl& c, const Vec3<double>& gravity, double* ddq, const double* motion,
                         Wanted&& wantedOf) {
  const PackedConstraints& packed = c.set.impl();
  const PlacedBodies bodies = placedBodies(d, c);
  const kernels::ConstraintKernels& k = kernels::constraintKernels();
  kernels::ConstraintWorkspace& x = c.workspace;
  ConstrainedViews out{motion, c.lambda, 0, c.solver.rank(), c.solver.solve(c.wanted, c.lambda)};
  k.respondToRows(packed, c.lambda, x);
  k.rowsOfResponse(packed, x, c.gamma);
  for (int r = 0; r < packed.rows; ++r) {
    c.left[r] = wantedOf(r) - c.gamma[r];
    if (!(std::abs(c.left[r]) <= out.residual)) out.residual = std::abs(c.left[r]);
  }
  c.solver.solve(c.left, c.step);
  k.respondToRows(packed, c.step, x);
  for (int r = 0; r < packed.rows; ++r) c.lambda[r] += c.step[r];
  bodies.run.takeResponse(m, bodies.memory, packed, x);
  accelerateBodies(m, d, c, gravity, ddq);
  return out;
}

void factorDelassus(ConstraintData& constraints) {
  ConstraintDataImpl& c = constraints.impl();
  c.solver.factor(c.workspace, constraints.settings);
}

}  // namespace

ConstrainedViews constraintDynamics(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau, ConstraintData& constraints,
                                    ConstraintMethod method, const Force<double>* fext, std::size_t count) {
  const char* algorithm = "constraintDynamics";
  checkConstraints(algorithm, model, data, constraints);
  checkSize(algorithm, "tau", tau, model.nv());
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau}, &c.block);
  // Without rows the result is that of aba to the last bit. The recursions for rows might round differently.
  if (c.set.rows() == 0 && method == ConstraintMethod::articulated) {
    factorDelassus(constraints);
    return {aba(model, data, q, v, tau, fext, count), c.lambda, 0, 0, 0};
  }
  freeMotion(algorithm, model, data, q, v, tau, fext, count, method == ConstraintMethod::kkt, c, false);
  factorDelassus(constraints);
  if (c.by_inertia) {
    const ConstrainedViews out = solved(c, d.ddq);
    addMotionOf(m, c, c.lambda, d.ddq);
    return out;
  }
  return refined(m, d, c, m.gravity, d.ddq, d.ddq, [&](int row) { return wantedOfResponse(c, row); });
}

ConstrainedViews impulseDynamics(const CompactModel& model, Data& data, VectorView q, VectorView v, double restitution, ConstraintData& constraints) {
  const char* algorithm = "impulseDynamics";
  checkConstraints(algorithm, model, data, constraints);
  checkRestitution(restitution);
  const CompactImpl& m = model.impl();
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v}, &c.block);
  double* change = d.ddq;
  ConstrainedViews out;
  const auto wanted = [&] {
    for (int r = 0; r < c.set.rows(); ++r) c.wanted[r] = -(1 + restitution) * c.motion.velocity[r];
  };
  if (!m.couplings.empty()) {
    projectInertia(algorithm, model, data, q, &v, c);
    factorDelassus(constraints);
    wanted();
    out = solved(c, c.v_after);
    std::fill_n(change, m.nv, 0.0);
    addMotionOf(m, c, c.lambda, change);
  } else {
    const Inputs in = readInputs(algorithm, model, data, q, &v, nullptr);
    articulateBodies(algorithm, m, d, c, in.q, d.zero, d.zero, nullptr);
    prepareRows(m, d, c, in.q, in.v);
    articulateRows(m, d, c);
    factorDelassus(constraints);
    wanted();
    out = refined(m, d, c, {}, change, c.v_after, [&](int row) { return c.wanted[row]; });
  }
  for (int i = 0; i < m.nv; ++i) c.v_after[i] = v.data[i] + change[i];
  return out;
}

ConstraintMotionViews constraintMotion(const CompactModel& model, Data& data, VectorView q, VectorView v, ConstraintData& constraints) {
  const char* algorithm = "computeConstraintMotion";
  checkConstraints(algorithm, model, data, constraints);
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q, .v = &v}, &c.block);
  placeRows(algorithm, model, data, q, &v, c);
  for (int r = 0; r < c.set.rows(); ++r) c.gamma[r] += c.motion.bias[r];
  return {c.motion.velocity, c.gamma, c.motion.error};
}

const double* constraintJacobian(const CompactModel& model, Data& data, VectorView q, ConstraintData& constraints) {
  const char* algorithm = "computeConstraintJacobian";
  checkConstraints(algorithm, model, data, constraints);
  ConstraintDataImpl& c = constraints.impl();
  copyAliasedArguments(data, {.q = &q}, &c.block);
  placeRows(algorithm, model, data, q, nullptr, c);
  return c.J;
}

}  // namespace dyn::detail
