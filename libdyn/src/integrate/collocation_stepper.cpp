// SPDX-License-Identifier: BSD-2-Clause
// Implicit Runge-Kutta methods of collocation in the chart about the step's start. Newton's method solves for the stages' accelerations:
//   k_i = a(q (+) u_i, v_i),  v_i = v + h sum a_ij k_j,  u_i = h sum a_ij (du/dt)_j.
// Newton's matrix approximates du/dt by v, and the iterations correct the difference. The blocks of the matrix are
//   delta_ij 1 - h a_ij da/dv - h^2 (A^2)_ij da/dq.
#include "at.hpp"
#include "integrate/stepper.hpp"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace dyn {

namespace {

constexpr int most_collocation_stages = 3;

struct CollocationTableau {
  int stages;
  std::array<std::array<double, most_collocation_stages>, most_collocation_stages> a;
  std::array<double, most_collocation_stages> b, c;
};

const double sqrt6 = std::sqrt(6.0), sqrt15 = std::sqrt(15.0);

// Hairer and Wanner 1996, tables IV.5.2 and IV.5.6.
const CollocationTableau midpoint{1, {{{0.5}}}, {1}, {0.5}};
const CollocationTableau gauss6{3,
                                {{{5.0 / 36, 2.0 / 9 - sqrt15 / 15, 5.0 / 36 - sqrt15 / 30},
                                  {5.0 / 36 + sqrt15 / 24, 2.0 / 9, 5.0 / 36 - sqrt15 / 24},
                                  {5.0 / 36 + sqrt15 / 30, 2.0 / 9 + sqrt15 / 15, 5.0 / 36}}},
                                {5.0 / 18, 4.0 / 9, 5.0 / 18},
                                {0.5 - sqrt15 / 10, 0.5, 0.5 + sqrt15 / 10}};
const CollocationTableau radau5{3,
                                {{{(88 - 7 * sqrt6) / 360, (296 - 169 * sqrt6) / 1800, (-2 + 3 * sqrt6) / 225},
                                  {(296 + 169 * sqrt6) / 1800, (88 + 7 * sqrt6) / 360, (-2 - 3 * sqrt6) / 225},
                                  {(16 - sqrt6) / 36, (16 + sqrt6) / 36, 1.0 / 9}}},
                                {(16 - sqrt6) / 36, (16 + sqrt6) / 36, 1.0 / 9},
                                {(4 - sqrt6) / 10, (4 + sqrt6) / 10, 1}};

class CollocationStepper : public CubicStepper {
 public:
  CollocationStepper(EquationsOfMotion& equations, const CollocationTableau& tableau)
      : CubicStepper(equations),
        tableau_(tableau),
        n_(equations.model().nv()),
        size_(tableau.stages * n_),
        k_(n_, tableau.stages),
        turning_(n_, tableau.stages),
        next_turning_(n_, tableau.stages),
        residual_(size_),
        change_(size_),
        u_(n_),
        rate_(n_),
        q_(equations.model().nq()),
        middle_v_(n_),
        v_(n_, tableau.stages),
        by_q_(n_, n_),
        by_v_(n_, n_),
        matrix_(size_, size_),
        solver_(std::max(size_, 1)) {
    for (int i = 0; i < tableau.stages; ++i)
      for (int j = 0; j < tableau.stages; ++j)
        for (int l = 0; l < tableau.stages; ++l) squared_[at(i)][at(j)] += tableau.a[at(i)][at(l)] * tableau.a[at(l)][at(j)];
  }

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    accelerationAt(equations_, from);
    k_ = from.a.replicate(1, tableau_.stages);
    turning_.setZero();
    next_turning_.setZero();
    if (const StepOutcome outcome = solve(from); outcome != StepOutcome::taken) return outcome;
    to.v = from.v;
    u_.setZero();
    for (int j = 0; j < tableau_.stages; ++j) {
      to.v += h * tableau_.b[at(j)] * k_.col(j);
      u_ += h * tableau_.b[at(j)] * (v_.col(j) + turning_.col(j));
    }
    chart_.point(from.q.data(), u_.data(), to.q.data());
    to.has_acceleration = false;
    return StepOutcome::taken;
  }

 private:
  /// Iterates until the changes are rounding errors. The first matrix takes one state's derivatives for all stages. If changes do not halve, the
  /// matrix is computed again with each stage's own derivatives, which differ much where loops are nearly singular.
  StepOutcome solve(const Moment& from) {
    constexpr int most_iterations = 60;
    factorizeMiddle(from);
    double before = std::numeric_limits<double>::infinity();
    for (int i = 0; i < most_iterations; ++i) {
      ++equations_.statistics.iterations;
      const double turned = evaluate(from);
      if (!residual_.allFinite()) return StepOutcome::not_finite;
      change_ = solver_.solve(residual_);
      const Eigen::Map<const Eigen::MatrixXd> change(change_.data(), n_, tableau_.stages);
      k_ -= change;
      const double size = std::max(turned, n_ > 0 ? h_ * change_.cwiseAbs().maxCoeff() : 0);
      if (!std::isfinite(size)) return StepOutcome::not_finite;
      const double scale = n_ > 0 ? std::max({from.v.cwiseAbs().maxCoeff(), h_ * k_.cwiseAbs().maxCoeff(), h_ * equations_.cancelled}) : 0;
      if (size <= rounding(0x1p-52, scale)) return StepOutcome::taken;
      if (size > 0.5 * before) {
        // No progress: a change as small as this is rounding error; otherwise the matrix belongs to another state.
        if (size <= rounding(0x1p-40, scale)) return StepOutcome::taken;
        factorizeStages(from);
      }
      before = size;
    }
    return StepOutcome::unsolved;
  }

  /// Factorises the matrix with the derivatives at the state in the middle of the present stages.
  void factorizeMiddle(const Moment& from) {
    middle_v_ = from.v + 0.5 * h_ / tableau_.stages * k_.rowwise().sum();
    u_ = 0.5 * h_ * from.v;
    chart_.point(from.q.data(), u_.data(), q_.data());
    differentiate(from.time + 0.5 * h_, middle_v_);
    for (int i = 0; i < tableau_.stages; ++i) writeRows(i);
    factorize();
  }

  void factorizeStages(const Moment& from) {
    stageVelocities(from);
    for (int i = 0; i < tableau_.stages; ++i) {
      placeStage(from, i);
      differentiate(from.time + tableau_.c[at(i)] * h_, v_.col(i));
      writeRows(i);
    }
    factorize();
  }

  /// Computes by_q_ and by_v_ at q_.
  template <class V>
  void differentiate(double t, const V& v) {
    equations_.derivatives(t, q_.data(), v.data(), MatrixMap(by_q_.data(), n_, n_), MatrixMap(by_v_.data(), n_, n_));
  }

  /// Writes the rows of stage i of Newton's matrix from the last derivatives.
  void writeRows(int i) {
    for (int j = 0; j < tableau_.stages; ++j) {
      auto block = matrix_.block(i * n_, j * n_, n_, n_);
      block = -h_ * tableau_.a[at(i)][at(j)] * by_v_ - h_ * h_ * squared_[at(i)][at(j)] * by_q_;
      if (i == j) block.diagonal().array() += 1;
    }
  }

  void factorize() {
    ++equations_.statistics.factorizations;
    solver_.compute(matrix_);
  }

  void stageVelocities(const Moment& from) {
    for (int i = 0; i < tableau_.stages; ++i) {
      v_.col(i) = from.v;
      for (int j = 0; j < tableau_.stages; ++j) v_.col(i) += h_ * tableau_.a[at(i)][at(j)] * k_.col(j);
    }
  }

  /// Computes q_ of stage i from all stages' velocities.
  void placeStage(const Moment& from, int i) {
    u_.setZero();
    for (int j = 0; j < tableau_.stages; ++j) u_ += h_ * tableau_.a[at(i)][at(j)] * (v_.col(j) + turning_.col(j));
    chart_.point(from.q.data(), u_.data(), q_.data());
  }

  /// Computes the stages of the present accelerations and their residuals. Returns the largest change of the chart's rates.
  double evaluate(const Moment& from) {
    stageVelocities(from);
    double changed = 0;
    for (int i = 0; i < tableau_.stages; ++i) {
      placeStage(from, i);
      chart_.rate(from.q.data(), q_.data(), v_.col(i).data(), rate_.data());
      const double* a = equations_.acceleration(from.time + tableau_.c[at(i)] * h_, q_.data(), v_.col(i).data());
      residual_.segment(i * n_, n_) = k_.col(i) - VectorResult(a, n_);
      rate_ -= v_.col(i);
      if (n_ > 0) changed = std::max(changed, (rate_ - next_turning_.col(i)).cwiseAbs().maxCoeff());
      next_turning_.col(i) = rate_;
    }
    turning_ = next_turning_;
    return changed;
  }

  const CollocationTableau& tableau_;
  int n_, size_;
  std::array<std::array<double, most_collocation_stages>, most_collocation_stages> squared_{};
  Eigen::MatrixXd k_;
  Eigen::MatrixXd turning_, next_turning_;  ///< du/dt - v by stage: not zero where a rotation axis itself turns
  Eigen::VectorXd residual_, change_, u_, rate_, q_, middle_v_;
  Eigen::MatrixXd v_, by_q_, by_v_, matrix_;
  Eigen::PartialPivLU<Eigen::MatrixXd> solver_;
};

}  // namespace

std::unique_ptr<Stepper> makeCollocationStepper(EquationsOfMotion& equations, Integrator integrator) {
  return std::make_unique<CollocationStepper>(equations, integrator == Integrator::radau5   ? radau5
                                                         : integrator == Integrator::gauss6 ? gauss6
                                                                                            : midpoint);
}

}  // namespace dyn
