// SPDX-License-Identifier: BSD-2-Clause
// Constrained dynamics compared with dense equations in extended precision, and laws that hold for all constraints.
#include "constraint/support.hpp"
#include "support/registry.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

TEST_CASE("rows are what frames' velocities and accelerations say", "[constraint]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 30)));
  const Subject s = randomScene(seed, 10, 4);
  Data data(s.model, Need::derivatives);
  ConstraintData c(ConstraintSet(s.model, s.constraints));
  const DenseRows rows = denseRows(s.model, data, s.constraints, s.q, s.v);
  const auto close = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return a.rows() == b.rows() && (a - b).cwiseAbs().maxCoeff() <= 1e-12 * (1 + b.cwiseAbs().maxCoeff());
  };
  CHECK(close(computeConstraintJacobian(s.model, data, s.q, c), rows.J));
  const ConstraintMotion motion = computeConstraintMotion(s.model, data, s.q, s.v, c);
  CHECK(close(motion.velocity, rows.velocity));
  CHECK(close(motion.bias, rows.gamma));
}

TEST_CASE("biases are the derivatives of the rows' velocities", "[constraint]") {
  const auto seed = static_cast<std::uint64_t>(GENERATE(range(1, 20)));
  Subject s = randomScene(seed, 8, 4);
  // Constraints of a point are the only exception, because they constrain the acceleration of the point itself. So there are none here.
  for (ConstraintDescription& d : s.constraints) std::get<FrameConstraint>(d.relation).free[5] = false;
  Data data(s.model, Need::derivatives);
  ConstraintData c(ConstraintSet(s.model, s.constraints));
  const Eigen::VectorXd a = s.tau, gamma = computeConstraintMotion(s.model, data, s.q, s.v, c).bias;
  const Eigen::VectorXd wanted = computeConstraintJacobian(s.model, data, s.q, c) * a + gamma;
  // q(t) with velocity v and acceleration a at t = 0: to second order in t for flat coordinates and to first order for others, for which central
  // differences restore the second order.
  const auto velocityAt = [&](double t) {
    const Eigen::VectorXd v = s.v + t * a, q = integrate(s.model, s.q, Eigen::VectorXd(t * s.v + 0.5 * t * t * a));
    return Eigen::VectorXd(computeConstraintMotion(s.model, data, q, v, c).velocity);
  };
  const double h = 1e-3;
  const Eigen::VectorXd rate = (8 * (velocityAt(h) - velocityAt(-h)) - (velocityAt(2 * h) - velocityAt(-2 * h))) / (12 * h);
  CHECK((rate - wanted).cwiseAbs().maxCoeff() <= 1e-6 * (1 + wanted.cwiseAbs().maxCoeff()));
}

TEST_CASE("accelerations and forces solve the dense equations", "[constraint]") {
  int judged = 0;
  for (std::uint64_t seed = 1; seed < 40; ++seed) {
    CAPTURE(seed);
    const Subject s = randomScene(seed, 12, 1 + static_cast<int>(seed % 3));
    Data data(s.model, Need::derivatives);
    const DenseRows rows = denseRows(s.model, data, s.constraints, s.q, s.v);
    const Eigen::MatrixXd M = crba(s.model, data, s.q);
    const Eigen::VectorXd h = nonLinearEffects(s.model, data, s.q, s.v);
    const DenseSolution wanted = solveKkt(M, rows.J, s.tau.cast<long double>() - h.cast<long double>(), -rows.gamma.cast<long double>());
    const LongMatrix D = rows.J.cast<long double>() * M.cast<long double>().ldlt().solve(LongMatrix(rows.J.transpose().cast<long double>()));
    const Eigen::VectorXd spectrum = D.cast<double>().selfadjointView<Eigen::Lower>().eigenvalues();
    const double largest = spectrum.maxCoeff();
    double smallest = largest;
    for (const double x : spectrum)
      if (x > 1e-12 * largest) smallest = std::min(smallest, x);
    // The error grows with the condition number of the nonzero part of the Delassus matrix.
    const double tolerance = 1e-14 * (largest / smallest) + 1e-11;
    if (tolerance > 1e-6) continue;  // nearly dependent rows: neither result is accurate
    ++judged;
    ConstraintData c(ConstraintSet(s.model, s.constraints));
    for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
      const ConstrainedMotion x = constraintDynamics(s.model, data, s.q, s.v, s.tau, c, method);
      INFO("condition " << largest / smallest << ", rank " << x.rank << " of " << rows.J.rows());
      CHECK(relativeTo(x.ddq, wanted.x) <= tolerance);
      CHECK(relativeTo(x.lambda, wanted.lambda) <= tolerance);
      const Eigen::VectorXd left = rows.J * Eigen::VectorXd(x.ddq) + rows.gamma;
      CHECK(std::abs(x.residual - left.cwiseAbs().maxCoeff()) <= tolerance * (1 + h.cwiseAbs().maxCoeff() + x.residual));
    }
    const ConstrainedImpact impact = impulseDynamics(s.model, data, s.q, s.v, 0.3, c);
    const DenseSolution after = solveKkt(M, rows.J, LongVector::Zero(s.model.nv()), -1.3L * rows.velocity.cast<long double>());
    CHECK(relativeTo(impact.v_after - s.v, after.x) <= tolerance);
    CHECK(relativeTo(impact.impulse, after.lambda) <= tolerance);
  }
  CHECK(judged >= 35);
}

TEST_CASE("what one evaluation leaves, even of numbers that are none, does not reach the next", "[constraint]") {
  for (std::uint64_t seed = 1; seed < 60; ++seed) {
    CAPTURE(seed);
    const Subject s = randomScene(seed, 12, 1 + static_cast<int>(seed % 4));
    const Eigen::VectorXd nothing = Eigen::VectorXd::Constant(s.model.nv(), std::nan("")), other = randomConfiguration(s.model, seed);
    for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
      const auto motionAt = [&](ConstraintData& c, Data& data) {
        const ConstrainedMotion x = constraintDynamics(s.model, data, s.q, s.v, s.tau, c, method);
        Eigen::VectorXd all(x.ddq.size() + x.lambda.size());
        all << x.ddq, x.lambda;
        return all;
      };
      Data fresh_data(s.model, Need::derivatives), used_data(s.model, Need::derivatives);
      ConstraintData fresh(ConstraintSet(s.model, s.constraints)), used(ConstraintSet(s.model, s.constraints));
      const Eigen::VectorXd wanted = motionAt(fresh, fresh_data);
      constraintDynamics(s.model, used_data, other, 10 * s.v, s.tau, used, method);
      Eigen::VectorXd q = other;
      q.tail(1).setConstant(std::nan(""));
      for (const Eigen::VectorXd& at : {other, q}) {
        try {
          constraintDynamics(s.model, used_data, at, nothing, nothing, used, method);
        } catch (const Error&) {  // pivots may be NaN
        }
      }
      const Eigen::VectorXd found = motionAt(used, used_data);
      CHECK(wanted.allFinite());
      CHECK((found - wanted).cwiseAbs().maxCoeff() == 0);
    }
  }
}
