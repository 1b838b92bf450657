#include "algorithm/inputs.hpp"
#include "constraint/linearize.hpp"
#include "constraint/solution.hpp"
#include "kernels/constraint_table.hpp"

#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/kinematics_derivatives.hpp>
#include <dyn/constraint/derivatives.hpp>
#include <dyn/error.hpp>

#include <algorithm>

namespace dyn::detail {

namespace {

using Matrix = Eigen::Map<Eigen::MatrixXd>;
using ConstMatrix = Eigen::Map<const Eigen::MatrixXd>;

void check(const char* algorithm, const CompactModel& model, const Data& data, const ConstraintData& constraints) {
  checkConstraints(algorithm, model, data, constraints);
  checkData(algorithm, model, data, Need::derivatives);
  if (!has(constraints.impl().needs, Need::derivatives))
    throw Error(
        ErrorCode::argument,
        std::string(algorithm) + ": the constraints' data was made without Need::derivatives; make it as ConstraintData(set, Need::derivatives)");
}

/// A call of the kernel for `count` columns with the model's M^-1, and with `rows` of the constraints' rows.
kernels::ConstrainedColumns columnsOf(const CompactModel& model, ConstraintDataImpl& c, int rows, int count) {
  return {model.nv(), rows, count, c.inertia, c.X, c.Xt, nullptr, nullptr, nullptr, nullptr, c.wanted, c.step, c.change, c.places};
}

/// M^-1 with gaps between its columns, c.X = M^-1 J^T likewise, and its transpose.
void projectRows(const CompactModel& model, const DataImpl& d, ConstraintDataImpl& c) {
  const std::ptrdiff_t n = model.nv(), rows = c.set.rows(), stride = c.workspace.stride, padded = kernels::ConstrainedColumns::padded(n);
  for (std::ptrdiff_t k = 0; k < n; ++k) std::copy_n(d.Minv + n * k, n, c.inertia + padded * k);
  for (std::ptrdiff_t r = 0; r < rows; ++r)
    for (std::ptrdiff_t k = 0; k < n; ++k) c.Jt[n * r + k] = -c.J[rows * k + r];
  kernels::ConstrainedColumns call = columnsOf(model, c, 0, static_cast<int>(rows));
  call.force = c.Jt;
  call.x = c.solved;
  call.lambda = c.left;
  kernels::constraintKernels().solveColumns(c.workspace, call);
  for (std::ptrdiff_t r = 0; r < rows; ++r) {
    std::copy_n(c.solved + n * r, n, c.X + padded * r);
    for (std::ptrdiff_t k = 0; k < n; ++k) c.Xt[stride * k + r] = c.solved[n * r + k];
  }
}

/// Solves M x - J^T lambda = -force, J x = -row for all columns; row may be null: zero.
void solveColumns(const CompactModel& model, ConstraintDataImpl& c, const double* force, const double* row, double* x, double* lambda) {
  const Eigen::Index n = model.nv(), rows = c.set.rows(), padded = kernels::ConstrainedColumns::padded(n);
  if (c.solver.regular()) {
    kernels::ConstrainedColumns call = columnsOf(model, c, c.set.rows(), model.nv());
    call.force = force;
    call.row = row;
    call.x = x;
    call.lambda = lambda;
    kernels::constraintKernels().solveColumns(c.workspace, call);
    return;
  }
  const ConstMatrix Minv(c.inertia, padded, n), X(c.X, padded, rows);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Eigen::Map<const Eigen::VectorXd> f(force + n * k, n);
    Eigen::Map<Eigen::VectorXd> change(x + n * k, n), wanted(c.wanted, rows), step(c.step, rows);
    wanted.noalias() = X.topRows(n).transpose().lazyProduct(f);
    if (row) wanted -= ConstMatrix(row, rows, n).col(k);
    c.solver.solve(c.wanted, c.step);
    change.noalias() = X.topRows(n).lazyProduct(step) - Minv.topRows(n).lazyProduct(f);
    Matrix(lambda, rows, n).col(k) = step;
  }
}

const double* expandedConfiguration(const CompactModel& model, const DataImpl& d, VectorView q) {
  return model.impl().couplings.empty() ? q.data : d.qx;
}

}  // namespace

ConstrainedDerivativeViews constraintDynamicsDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, VectorView tau,
                                                         ConstraintData& constraints) {
  check("computeConstraintDynamicsDerivatives", model, data, constraints);
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  const Eigen::Index n = model.nv();
  constraintDynamics(model, data, q, v, tau, constraints, ConstraintMethod::articulated, nullptr, 0);
  std::copy_n(d.ddq, n, c.v_after);
  const VectorView ddq{c.v_after, n};
  rowForcesOnBodies(model, d, c, c.fext);
  rneaDerivatives(model, data, q, &v, &ddq, c.fext, model.impl().joints.size());
  std::copy_n(d.dtau_dq, n * n, c.force);
  forwardKinematicsDerivatives(model, data, q, v, ddq);
  linearizeRows(model, d, c, expandedConfiguration(model, d, q), RowQuantity::acceleration, {c.row_by_q, c.row_by_v, c.J, c.force});
  minverse(model, data, q);
  projectRows(model, d, c);
  solveColumns(model, c, c.force, c.row_by_q, c.motion_dq, c.lambda_dq);
  solveColumns(model, c, d.dtau_dv, c.row_by_v, c.motion_dv, c.lambda_dv);
  std::fill_n(c.force, n * n, 0.0);
  Matrix(c.force, n, n).diagonal().setConstant(-1);
  solveColumns(model, c, c.force, nullptr, c.motion_dtau, c.lambda_dtau);
  return {c.v_after, c.lambda, c.motion_dq, c.motion_dv, c.motion_dtau, c.lambda_dq, c.lambda_dv, c.lambda_dtau};
}

ConstrainedDerivativeViews impulseDynamicsDerivatives(const CompactModel& model, Data& data, VectorView q, VectorView v, double restitution,
                                                      ConstraintData& constraints) {
  check("computeImpulseDynamicsDerivatives", model, data, constraints);
  DataImpl& d = data.impl();
  ConstraintDataImpl& c = constraints.impl();
  const Eigen::Index n = model.nv(), rows = c.set.rows();
  impulseDynamics(model, data, q, v, restitution, constraints);
  const VectorView zero{d.zero, n};
  // M (v_after - v) - J^T impulse by q: inverse dynamics at rest with the change for an acceleration, less gravity.
  for (Eigen::Index k = 0; k < n; ++k) c.change[k] = c.v_after[k] - v.data[k];
  const VectorView change{c.change, n};
  rowForcesOnBodies(model, d, c, c.fext);
  rneaDerivatives(model, data, q, nullptr, nullptr, nullptr, 0);
  Matrix(c.force, n, n) = -Matrix(d.dtau_dq, n, n);
  rneaDerivatives(model, data, q, &zero, &change, c.fext, model.impl().joints.size());
  Matrix(c.force, n, n) += Matrix(d.dtau_dq, n, n);
  // J (v_after + restitution v) = 0.
  double* sum = c.expanded;
  for (Eigen::Index k = 0; k < n; ++k) sum[k] = c.v_after[k] + restitution * v.data[k];
  forwardKinematicsDerivatives(model, data, q, {sum, n}, zero);
  linearizeRows(model, d, c, expandedConfiguration(model, d, q), RowQuantity::velocity, {c.row_by_q, nullptr, c.J, c.force});
  minverse(model, data, q);
  projectRows(model, d, c);
  solveColumns(model, c, c.force, c.row_by_q, c.motion_dq, c.lambda_dq);
  // By v: M (dv_after - dv) = J^T dimpulse, J dv_after = -restitution J dv.
  std::fill_n(c.force, n * n, 0.0);
  Matrix(c.row_by_v, rows, n) = (1 + restitution) * Matrix(c.J, rows, n);
  solveColumns(model, c, c.force, c.row_by_v, c.motion_dv, c.lambda_dv);
  Matrix(c.motion_dv, n, n).diagonal().array() += 1;
  return {c.v_after, c.lambda, c.motion_dq, c.motion_dv, nullptr, c.lambda_dq, c.lambda_dv, nullptr};
}

}  // namespace dyn::detail
