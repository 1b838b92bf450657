// SPDX-License-Identifier: BSD-2-Clause
// Explicit Runge-Kutta methods in the chart about the step's start. Stage i is at u_i = h sum a_ij (du/dt)_j, v_i = v + h sum a_ij (dv/dt)_j.
#include "integrate/stepper.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace dyn {

namespace {

constexpr int most_explicit_stages = 7;

struct ExplicitTableau {
  int stages;
  std::array<std::array<double, most_explicit_stages>, most_explicit_stages> a;
  std::array<double, most_explicit_stages> b, c;
  std::array<double, most_explicit_stages> error;  ///< b - b of the embedded method; zero if there is none
  bool ends_at_last_stage;                         ///< b is the last row of a, so the last stage is the step's end
};

constexpr ExplicitTableau kutta{4,    {{{}, {1.0 / 2}, {0, 1.0 / 2}, {0, 0, 1}}}, {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}, {0, 1.0 / 2, 1.0 / 2, 1}, {},
                                false};

// Hairer, Norsett and Wanner 1993, table II.5.2.
constexpr ExplicitTableau dormand_prince{7,
                                         {{{},
                                           {1.0 / 5},
                                           {3.0 / 40, 9.0 / 40},
                                           {44.0 / 45, -56.0 / 15, 32.0 / 9},
                                           {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                                           {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                                           {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}}},
                                         {35.0 / 384, 0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84, 0},
                                         {0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1, 1},
                                         {71.0 / 57600, 0, -71.0 / 16695, 71.0 / 1920, -17253.0 / 339200, 22.0 / 525, -1.0 / 40},
                                         true};

/// Returns the weights of Dormand and Prince's stages for the state at theta, of fourth order (Hairer, Norsett and Wanner 1993, eq. II.6.20 and on).
std::array<double, most_explicit_stages> dormandPrinceAt(double theta) {
  const double s = theta, blend = s * s * (3 - 2 * s), bump = s * s * (s - 1) * (s - 1);
  const auto& b = dormand_prince.b;
  return {blend * b[0] + s * (s - 1) * (s - 1) - bump * 5 * (2558722523 - 31403016 * s) / 11282082432,
          0,
          blend * b[2] + bump * 100 * (882725551 - 15701508 * s) / 32700410799,
          blend * b[3] - bump * 25 * (443332067 - 31403016 * s) / 1880347072,
          blend * b[4] + bump * 32805 * (23143187 - 3489224 * s) / 199316789632,
          blend * b[5] - bump * 55 * (29972135 - 7076736 * s) / 822651844,
          s * s * (s - 1) + bump * 10 * (7414447 - 829305 * s) / 29380423};
}

class ExplicitStepper : public CubicStepper {
 public:
  ExplicitStepper(EquationsOfMotion& equations, const ExplicitTableau& tableau, double tolerance)
      : CubicStepper(equations),
        tableau_(tableau),
        tolerance_(tolerance),
        rates_(equations.model().nv(), tableau.stages),
        accelerations_(equations.model().nv(), tableau.stages),
        u_(equations.model().nv()),
        v_(equations.model().nv()),
        q_(equations.model().nq()) {}

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    rates_.col(0) = from.v;
    accelerations_.col(0) = VectorResult(accelerationAt(equations_, from), from.v.size());
    for (int i = 1; i < tableau_.stages; ++i) {
      const bool last = tableau_.ends_at_last_stage && i + 1 == tableau_.stages;
      Eigen::VectorXd &q = last ? to.q : q_, &v = last ? to.v : v_;
      advance(from, tableau_.a[static_cast<std::size_t>(i)], i, q, v);
      chart_.rate(from.q.data(), q.data(), v.data(), rates_.col(i).data());
      const double time = last ? to.time : from.time + tableau_.c[static_cast<std::size_t>(i)] * h;
      accelerations_.col(i) = VectorResult(equations_.acceleration(time, q.data(), v.data()), v.size());
    }
    if (tableau_.ends_at_last_stage) {
      to.a = accelerations_.col(tableau_.stages - 1);
    } else {
      advance(from, tableau_.b, tableau_.stages, to.q, to.v);
    }
    to.has_acceleration = tableau_.ends_at_last_stage;
    if (tolerance_ > 0) estimate(from, to);
    return StepOutcome::taken;
  }

  double error() const override { return error_; }
  int worst() const override { return worst_; }

  void between(double theta, Moment& from, Moment& to, double* q, double* v) override {
    if (tolerance_ <= 0) return CubicStepper::between(theta, from, to, q, v);
    advance(from, dormandPrinceAt(theta), tableau_.stages, q_, v_);
    VectorMap(q, q_.size()) = q_;
    VectorMap(v, v_.size()) = v_;
  }

 private:
  /// Computes q and v from the step's start by the first `stages` stages with these weights.
  void advance(const Moment& from, const std::array<double, most_explicit_stages>& weights, int stages, Eigen::VectorXd& q, Eigen::VectorXd& v) {
    bool first = true;
    for (int j = 0; j < stages; ++j) {
      const double w = h_ * weights[static_cast<std::size_t>(j)];
      if (w == 0) continue;
      if (first) {
        u_ = w * rates_.col(j);
        v = from.v + w * accelerations_.col(j);
      } else {
        u_ += w * rates_.col(j);
        v += w * accelerations_.col(j);
      }
      first = false;
    }
    chart_.point(from.q.data(), u_.data(), q.data());
  }

  void estimate(const Moment& from, const Moment& to) {
    u_.setZero();
    v_.setZero();
    for (int j = 0; j < tableau_.stages; ++j) {
      const double w = h_ * tableau_.error[static_cast<std::size_t>(j)];
      u_ += w * rates_.col(j);
      v_ += w * accelerations_.col(j);
    }
    error_ = 0;
    const auto take = [&](Eigen::Index k, double e) {
      if (e <= error_ || std::isnan(error_)) return;  // NaN stays
      error_ = e;
      worst_ = static_cast<int>(k);
    };
    for (Eigen::Index k = 0; k < u_.size(); ++k) {
      take(k, std::abs(u_[k]) / tolerance_);
      // No shorter step reduces the rounding errors of fast velocities, so they are allowed.
      const double rounding = 0x1p-48 * std::max(std::abs(from.v[k]), std::abs(to.v[k]));
      take(k, std::abs(v_[k]) / (tolerance_ + rounding));
    }
  }

  const ExplicitTableau& tableau_;
  double tolerance_;
  Eigen::MatrixXd rates_, accelerations_;
  Eigen::VectorXd u_, v_, q_;
  double error_ = 0;
  int worst_ = 0;
};

}  // namespace

std::unique_ptr<Stepper> makeExplicitStepper(EquationsOfMotion& equations, const SimulatorOptions& options) {
  const bool adaptive = options.integrator == Integrator::dormand_prince;
  return std::make_unique<ExplicitStepper>(equations, adaptive ? dormand_prince : kutta, adaptive ? options.tolerance : 0);
}

}  // namespace dyn
