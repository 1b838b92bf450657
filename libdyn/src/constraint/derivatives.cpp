#include "algorithm/inputs.hpp"
#include "constraint/linearize.hpp"
#include "constraint/solution.hpp"

#include <dyn/algorithm/derivatives.hpp>
#include <dyn/algorithm/kinematics_derivatives.hpp>
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

/// Solves M dx - J^T dlambda = -force, J dx = -row for the columns of both; the first comes in `motion` as force and becomes dx.
void solveColumns(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c, double* motion, const double* row, double* lambda) {
  const Eigen::Index n = model.nv(), rows = c.set.rows();
  const Matrix Minv(d.Minv, n, n), J(c.J, rows, n), X(c.X, n, rows);
  Matrix dx(motion, n, n), dlambda(lambda, rows, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Map<Eigen::VectorXd> change(c.change, n), wanted(c.wanted, rows), step(c.step, rows);
    change.noalias() = -Minv.lazyProduct(dx.col(k));
    wanted.noalias() = -J.lazyProduct(change);
    if (row) wanted -= Matrix(const_cast<double*>(row), rows, n).col(k);
    c.solver.solve(c.wanted, c.step);
    dlambda.col(k) = step;
    dx.col(k) = change;
    dx.col(k).noalias() += X.lazyProduct(step);
  }
}

/// c.X = M^-1 J^T.
void projectRows(const CompactModel& model, DataImpl& d, ConstraintDataImpl& c) {
  const Eigen::Index n = model.nv(), rows = c.set.rows();
  Matrix(c.X, n, rows).noalias() = Matrix(d.Minv, n, n).lazyProduct(Matrix(c.J, rows, n).transpose());
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
  forwardKinematicsDerivatives(model, data, q, v, ddq);
  rowForcesOnBodies(model, d, c, c.fext);
  rneaDerivatives(model, data, q, &v, &ddq, c.fext, model.impl().joints.size());
  forwardKinematicsDerivatives(model, data, q, v, ddq);  // inverse dynamics has its own accelerations
  linearizeRows(model, d, c, expandedConfiguration(model, d, q), RowQuantity::acceleration, {c.row_by_q, c.row_by_v, c.J, d.dtau_dq});
  std::copy_n(d.dtau_dq, n * n, c.motion_dq);
  std::copy_n(d.dtau_dv, n * n, c.motion_dv);
  minverse(model, data, q);
  projectRows(model, d, c);
  solveColumns(model, d, c, c.motion_dq, c.row_by_q, c.lambda_dq);
  solveColumns(model, d, c, c.motion_dv, c.row_by_v, c.lambda_dv);
  Matrix(c.motion_dtau, n, n).setIdentity();
  Matrix(c.motion_dtau, n, n) *= -1;
  solveColumns(model, d, c, c.motion_dtau, nullptr, c.lambda_dtau);
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
  rneaDerivatives(model, data, q, nullptr, nullptr, nullptr, 0);
  for (Eigen::Index k = 0; k < n * n; ++k) c.motion_dq[k] = -d.dtau_dq[k];
  forwardKinematicsDerivatives(model, data, q, zero, zero);
  rowForcesOnBodies(model, d, c, c.fext);
  rneaDerivatives(model, data, q, &zero, &change, c.fext, model.impl().joints.size());
  // J (v_after + restitution v) = 0.
  double* sum = c.expanded;
  for (Eigen::Index k = 0; k < n; ++k) sum[k] = c.v_after[k] + restitution * v.data[k];
  forwardKinematicsDerivatives(model, data, q, {sum, n}, zero);
  linearizeRows(model, d, c, expandedConfiguration(model, d, q), RowQuantity::velocity, {c.row_by_q, nullptr, c.J, d.dtau_dq});
  for (Eigen::Index k = 0; k < n * n; ++k) c.motion_dq[k] += d.dtau_dq[k];
  minverse(model, data, q);
  projectRows(model, d, c);
  solveColumns(model, d, c, c.motion_dq, c.row_by_q, c.lambda_dq);
  // By v: M (dv_after - dv) = J^T dimpulse, J dv_after = -restitution J dv.
  Matrix(c.motion_dv, n, n).setZero();
  Matrix(c.row_by_v, rows, n) = (1 + restitution) * Matrix(c.J, rows, n);
  solveColumns(model, d, c, c.motion_dv, c.row_by_v, c.lambda_dv);
  Matrix(c.motion_dv, n, n).diagonal().array() += 1;
  return {c.v_after, c.lambda, c.motion_dq, c.motion_dv, nullptr, c.lambda_dq, c.lambda_dv, nullptr};
}

}  // namespace dyn::detail
