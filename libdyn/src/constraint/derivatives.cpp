// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/derivatives.hpp"

#include "algorithm/support/inputs.hpp"
#include "constraint/linearize.hpp"
#include "constraint/solution.hpp"
#include "kernels/isa/constraint_table.hpp"

#include <dyn/constraint/derivatives.hpp>
#include <dyn/error.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

using Matrix = Eigen::Map<Eigen::MatrixXd>;

void check(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints) {
  checkConstraints(algorithm, model, data, constraints);
  checkData(algorithm, model, data, Need::derivatives);
  if (!has(constraints.impl().needs, Need::derivatives))
    throw Error(
        ErrorCode::argument,
        std::string(algorithm) + ": the constraints' data was made without Need::derivatives; make it as ConstraintData(set, Need::derivatives)");
}

/// Forms the inverse of the equations of motion in c.inverse, from d.Minv, c.J and the Delassus matrix that was factored last. It factors without mu:
/// proximal iterations remove the effect of mu, but not for right-hand sides that no motion of the rows can produce. Unless null, motion_by_force and
/// lambda_by_force get the derivatives of motions and lambda by forces.
void invertConstrained(const DataImpl& d, ConstraintData& constraints, double* motion_by_force, double* lambda_by_force) {
  ConstraintDataImpl& c = constraints.impl();
  if (constraints.settings.mu > 0) {
    ConstraintSettings exact = constraints.settings;
    exact.mu = 0;
    c.solver.factor(c.workspace, exact);
  }
  const int rows = c.set.rows();
  for (int r = 0; r < rows; ++r) {
    if (c.solver.regular()) {
      std::copy_n(c.workspace.inverse + c.workspace.stride * r, rows, c.inverse.of_row[r]);
    } else {
      std::fill_n(c.wanted, rows, 0.0);
      c.wanted[r] = 1;
      c.solver.solve(c.wanted, c.step);
      std::copy_n(c.step, rows, c.inverse.of_row[r]);
    }
  }
  kernels::constraintKernels().invertConstrained(d.Minv, c.J, c.pattern->moving, c.inverse, motion_by_force, lambda_by_force);
}

void solve(const ConstraintDataImpl& c, int sides, const kernels::ConstrainedColumns& columns) {
  kernels::constraintKernels().solveConstrained[sides - 1](c.inverse, c.pattern->columns(), columns);
}

/// The state in expanded coordinates, after forceDerivatives at this state.
Inputs expanded(const CompactModel& model, const DataImpl& d, const double* q, const double* v, const double* a) {
  if (model.impl().couplings.empty()) return {q, v, a};
  return {d.qx, d.vx, d.ax};
}

}  // namespace

ConstrainedDerivativeViews constraintDynamicsDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau,
                                                         ConstraintData& constraints) {
  const char* algorithm = "computeConstraintDynamicsDerivatives";
  check(algorithm, model, data, constraints);
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  const std::ptrdiff_t n = model.nv(), rows = c.set.rows();
  copyAliasedArguments(data, {.q = &q, .v = &v, .tau = &tau}, &c.block);
  constraintDynamics(model, data, q, v, tau, constraints, ConstraintMethod::articulated, nullptr, 0);
  std::copy_n(d.ddq, n, c.v_after);
  const VectorView ddq{c.v_after, n};
  rowForcesOnBodies(model, c, c.fext);
  forceDerivatives(algorithm, model, data, q, &v, &ddq, c.fext, model.impl().joints.size());
  double *force_by_q = d.dtau_dq, *force_by_v = d.dtau_dv;
  if (c.pattern->forces_turn) {
    // Separate matrices, because inverse dynamics relies on zeros in its own where the tree has no root paths.
    force_by_q = c.force;
    force_by_v = c.force + n * n;
    std::copy_n(d.dtau_dq, n * n, force_by_q);
    std::copy_n(d.dtau_dv, n * n, force_by_v);
  }
  linearizeRows(model, d, c, expanded(model, d, q.data, v.data, ddq.data), true, {c.row_by_q, c.row_by_v, c.J, force_by_q, rows, n});
  inverseInertia(algorithm, model, data, q);
  invertConstrained(d, constraints, c.motion_dtau, c.lambda_dtau);
  solve(c, 2,
        {force_by_q, c.row_by_q, c.motion_dq, c.lambda_dq, force_by_v - force_by_q, c.row_by_v - c.row_by_q, c.motion_dv - c.motion_dq,
         c.lambda_dv - c.lambda_dq});
  return {c.v_after, c.lambda, c.motion_dq, c.motion_dv, c.motion_dtau, c.lambda_dq, c.lambda_dv, c.lambda_dtau};
}

ConstrainedDerivativeViews impulseDynamicsDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, double restitution,
                                                      ConstraintData& constraints) {
  const char* algorithm = "computeImpulseDynamicsDerivatives";
  check(algorithm, model, data, constraints);
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  const Eigen::Index n = model.nv(), rows = c.set.rows();
  copyAliasedArguments(data, {.q = &q, .v = &v}, &c.block);
  impulseDynamics(model, data, q, v, restitution, constraints);
  const VectorView zero{d.zero, n};
  // M (v_after - v) - J^T impulse by q: inverse dynamics at rest with the change for an acceleration, less gravity.
  for (Eigen::Index k = 0; k < n; ++k) c.change[k] = c.v_after[k] - v.data[k];
  const VectorView change{c.change, n};
  rowForcesOnBodies(model, c, c.fext);
  forceDerivatives(algorithm, model, data, q, nullptr, nullptr, nullptr, 0);
  Matrix(c.force, n, n) = -Matrix(d.dtau_dq, n, n);
  forceDerivatives(algorithm, model, data, q, &zero, &change, c.fext, model.impl().joints.size());
  Matrix(c.force, n, n) += Matrix(d.dtau_dq, n, n);
  // J (v_after + restitution v) = 0: accelerations of the rows from rest, without gravity.
  double* sum = c.expanded;
  for (Eigen::Index k = 0; k < n; ++k) sum[k] = c.v_after[k] + restitution * v.data[k];
  const VectorView velocities{sum, n};
  forceDerivatives(algorithm, model, data, q, &zero, &velocities, nullptr, 0);
  linearizeRows(model, d, c, expanded(model, d, q.data, zero.data, sum), false, {c.row_by_q, c.row_by_v, c.J, c.force, rows, n});
  inverseInertia(algorithm, model, data, q);
  invertConstrained(d, constraints, nullptr, nullptr);
  solve(c, 1, {c.force, c.row_by_q, c.motion_dq, c.lambda_dq, 0, 0, 0, 0});
  // By v: M (dv_after - dv) = J^T dimpulse, J dv_after = -restitution J dv.
  Matrix(c.row_by_v, rows, n) = (1 + restitution) * Matrix(c.J, rows, n);
  solve(c, 1, {nullptr, c.row_by_v, c.motion_dv, c.lambda_dv, 0, 0, 0, 0});
  Matrix(c.motion_dv, n, n).diagonal().array() += 1;
  return {c.v_after, c.lambda, c.motion_dq, c.motion_dv, nullptr, c.lambda_dq, c.lambda_dv, nullptr};
}

}  // namespace dyn::detail
