// SPDX-License-Identifier: BSD-2-Clause
// The explicit methods of fixed steps (euler_stepper.cpp, explicit_stepper.cpp) with the accelerations of all states from one call of aba.
#include "algorithm/support/turning.hpp"
#include "integrate/chart.hpp"

#include <dyn/algorithm/batch.hpp>
#include <dyn/error.hpp>
#include <dyn/integrate/batch_stepper.hpp>

#include <array>
#include <string>

namespace dyn {

namespace {

using View = detail::StatesView<double>;

/// Weight of each stage's rate in the next stage, and in the step.
struct RungeKuttaStage {
  double next, step;
};
constexpr std::array<RungeKuttaStage, 4> kutta_stages{{{0.5, 1.0 / 6}, {0.5, 1.0 / 3}, {1, 1.0 / 3}, {0, 1.0 / 6}}};

void checkColumns(const char* name, std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t rows_wanted, std::ptrdiff_t cols_wanted) {
  if (rows == rows_wanted && cols == cols_wanted) return;
  throw Error(ErrorCode::size, std::string("BatchStepper: ") + name + " is " + std::to_string(rows) + " x " + std::to_string(cols) + ", it must be " +
                                   std::to_string(rows_wanted) + " x " + std::to_string(cols_wanted));
}

View part(const View& x, std::ptrdiff_t first, std::ptrdiff_t count) { return {x.data + first * x.stride, x.rows, count, x.stride, true}; }
View viewOf(const MatrixOut& x) { return {x.column(0), x.rows(), x.cols(), x.stride(), true}; }
MatrixOut part(const MatrixOut& x, std::ptrdiff_t first, std::ptrdiff_t count) { return {x.column(first), x.rows(), count, x.stride()}; }

}  // namespace

struct BatchStepper::Impl {
  Impl(const CompactModel& m, int capacity, Integrator integrator, int threads)
      : model(m),
        method(integrator),
        batch(m, capacity, Need::state, threads),
        chart(m),
        u(m.nv()),
        rate(m.nv()),
        q(m.nq(), integrator == Integrator::rk4 ? capacity : 0),
        v(m.nv(), q.cols()),
        rates(m.nv(), q.cols()),
        accelerations(m.nv(), q.cols()) {}

  /// From the states q0 and v0 to `to_q` and `to_v`, which may be the same memory.
  void step(double h, const View& q0, const View& v0, const View& tau, const MatrixOut& to_q, const MatrixOut& to_v) {
    if (method == Integrator::rk4) return rungeKutta(h, q0, v0, tau, to_q, to_v);
    const double* const ddq = detail::runBatch<double>(model, batch, Algorithm::aba, q0, v0, tau).results[0];
    const Eigen::Index n = model.nv();
    for (std::ptrdiff_t k = 0; k < q0.cols; ++k) {
      const VectorResult from(v0.data + k * v0.stride, n);
      Eigen::Map<Eigen::VectorXd> to(to_v.column(k), n);
      rate = VectorResult(ddq + k * n, n);
      addTurning(model.impl(), from.data(), rate.data());
      u = h * from;
      to = from + h * rate;
      if (method == Integrator::semi_implicit_euler) u = h * to;
      chart.pointInHeldAxes(q0.data + k * q0.stride, u.data(), to.data(), to_q.column(k));
    }
  }

 private:
  void rungeKutta(double h, const View& q0, const View& v0, const View& tau, const MatrixOut& to_q, const MatrixOut& to_v) {
    const Eigen::Index n = model.nv();
    const View stage_q{q.data(), q.rows(), q0.cols, q.rows(), true}, stage_v{v.data(), n, q0.cols, n, true};
    for (std::size_t s = 0; s < kutta_stages.size(); ++s) {
      const RungeKuttaStage weight = kutta_stages[s];
      const bool first = s == 0, last = s + 1 == kutta_stages.size();
      const double* const ddq = detail::runBatch<double>(model, batch, Algorithm::aba, first ? q0 : stage_q, first ? v0 : stage_v, tau).results[0];
      for (std::ptrdiff_t k = 0; k < q0.cols; ++k) {
        const double* const start = q0.data + k * q0.stride;
        const VectorResult from(v0.data + k * v0.stride, n), a(ddq + k * n, n);
        if (first) {
          rate = from;
          rates.col(k).setZero();
          accelerations.col(k).setZero();
        } else {
          chart.rate(start, q.col(k).data(), v.col(k).data(), rate.data());
        }
        rates.col(k) += weight.step * rate;
        accelerations.col(k) += weight.step * a;
        if (last) {
          u = h * rates.col(k);
          Eigen::Map<Eigen::VectorXd>(to_v.column(k), n) = from + h * accelerations.col(k);
          chart.point(start, u.data(), to_q.column(k));
        } else {
          u = h * weight.next * rate;
          v.col(k) = from + h * weight.next * a;
          chart.point(start, u.data(), q.col(k).data());
        }
      }
    }
  }

 public:
  CompactModel model;
  Integrator method;
  BatchData batch;
  Chart chart;
  Eigen::VectorXd u, rate;               ///< of one state
  Eigen::MatrixXd q, v;                  ///< the next stage
  Eigen::MatrixXd rates, accelerations;  ///< sums over the stages
};

BatchStepper::BatchStepper(const CompactModel& model, int capacity, Integrator method, int threads)
    : impl_([&] {
        if (method != Integrator::explicit_euler && method != Integrator::semi_implicit_euler && method != Integrator::rk4)
          throw Error(ErrorCode::argument, std::string("BatchStepper: ") + infoOf(method).name +
                                               " is no explicit method of fixed steps; give explicit_euler, semi_implicit_euler or rk4");
        return std::make_unique<Impl>(model, capacity, method, threads);
      }()) {}
BatchStepper::~BatchStepper() = default;
BatchStepper::BatchStepper(BatchStepper&&) noexcept = default;
BatchStepper& BatchStepper::operator=(BatchStepper&&) noexcept = default;

void BatchStepper::advance(double dt, View tau, const MatrixOut& q, const MatrixOut& v) {
  checkColumns("V", v.rows(), v.cols(), impl_->model.nv(), q.cols());
  impl_->step(dt, viewOf(q), viewOf(v), tau, q, v);
}

void BatchStepper::run(double dt, View q0, View v0, View tau, const MatrixOut& q, const MatrixOut& v) {
  Impl& x = *impl_;
  const std::ptrdiff_t n = q0.cols;
  if (n == 0 || tau.cols % n != 0)
    throw Error(ErrorCode::size, "BatchStepper: Tau has " + std::to_string(tau.cols) + " columns; it must have some for each step of the " +
                                     std::to_string(n) + " states");
  checkColumns("Q", q.rows(), q.cols(), x.model.nq(), tau.cols);
  checkColumns("V", v.rows(), v.cols(), x.model.nv(), tau.cols);
  for (std::ptrdiff_t first = 0; first < tau.cols; first += n) {
    const MatrixOut to_q = part(q, first, n), to_v = part(v, first, n);
    x.step(dt, q0, v0, part(tau, first, n), to_q, to_v);
    q0 = viewOf(to_q);
    v0 = viewOf(to_v);
  }
}

}  // namespace dyn
