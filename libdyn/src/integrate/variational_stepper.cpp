// The variational integrator of the discrete Lagrangian L_d(q0, q1) = h L(q0 (+) h xi / 2, xi), q1 = q0 (+) h xi (Marsden and West 2001, sec.
// 1.3 and 3; on groups Bou-Rabee and Marsden 2009). In momenta p = M v, with F = C^T xi - g + forces the rate of p at the midpoint,
//   p0 = X^T p - h/2 Y0^T F,   p1 = X^T p + h/2 Y1^T F,   p = M(q) xi:
// the first is solved for xi, the second gives p1. X, Y0, Y1 are 1 for coordinates that add; otherwise see Chart::midpointMaps.
#include "integrate/stepper.hpp"

#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/coriolis.hpp>
#include <dyn/algorithm/crba.hpp>

#include <cmath>

namespace dyn {

namespace {

class VariationalStepper : public CubicStepper {
 public:
  explicit VariationalStepper(Law& law)
      : CubicStepper(law),
        n_(law.model().nv()),
        xi_(n_),
        u_(n_),
        momentum_(n_),
        start_momentum_(n_),
        rate_(n_),
        at_start_(n_),
        at_end_(n_),
        residual_(n_),
        q_(law.model().nq()) {}

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    start_momentum_.noalias() = massMatrix(from.q) * from.v;
    accelerationAt(from);
    xi_ = from.v + 0.5 * h * from.a;
    if (!solve(from, to)) return StepOutcome::unsolved;
    massMatrix(to.q);
    cholesky::decompose(law_.model(), law_.data());
    to.v = momentum_ + 0.5 * h * at_end_;
    cholesky::solve(law_.model(), law_.data(), to.v);
    to.has_acceleration = false;
    return StepOutcome::taken;
  }

 private:
  MatrixResult massMatrix(const Eigen::VectorXd& q) { return crba(law_.model(), law_.data(), q); }

  /// M at the midpoint is the matrix: what it lacks is of the order of h, the ratio by which changes shrink.
  bool solve(const Moment& from, Moment& to) {
    constexpr int most_iterations = 200;
    double before = std::numeric_limits<double>::infinity();
    int no_better = 0;
    for (int i = 0; i < most_iterations; ++i) {
      ++law_.statistics.iterations;
      evaluate(from, to);
      residual_ = momentum_ - 0.5 * h_ * at_start_ - start_momentum_;
      cholesky::solve(law_.model(), law_.data(), residual_);
      xi_ -= residual_;
      const double size = n_ > 0 ? residual_.cwiseAbs().maxCoeff() : 0, scale = n_ > 0 ? xi_.cwiseAbs().maxCoeff() : 0;
      if (!residual_.allFinite()) return false;
      if (size <= 0x1p-52 * scale) break;
      if (size > 0.5 * before && size <= 0x1p-40 * scale) break;
      no_better = size > before ? no_better + 1 : 0;
      if (no_better == 5 || i + 1 == most_iterations) return false;
      before = size;
    }
    evaluate(from, to);
    return true;
  }

  /// momentum_ = X^T p and the two ends' forces at the present xi; leaves the factors of M at the midpoint.
  void evaluate(const Moment& from, Moment& to) {
    const CompactModel& model = law_.model();
    Data& data = law_.data();
    u_ = h_ * xi_;
    chart_.point(from.q.data(), u_.data(), to.q.data());
    u_ *= 0.5;
    chart_.point(from.q.data(), u_.data(), q_.data());
    u_ *= 2;
    // F = (C + C^T) xi - (C xi + g + losses) + applied forces: gravity and losses come from rnea alone.
    rate_ = VectorResult(law_.applied(from.time + 0.5 * h_, q_.data(), xi_.data()), n_);
    rate_ -= nonLinearEffects(model, data, q_, xi_);
    const MatrixResult C = computeCoriolisMatrix(model, data, q_, xi_);
    rate_.noalias() += C * xi_;
    rate_.noalias() += C.transpose() * xi_;
    momentum_.noalias() = massMatrix(q_) * xi_;
    cholesky::decompose(model, data);
    chart_.midpointMaps(from.q.data(), u_.data(), to.q.data(), momentum_.data(), rate_.data(), at_start_.data(), at_end_.data());
  }

  int n_;
  Eigen::VectorXd xi_, u_, momentum_, start_momentum_, rate_, at_start_, at_end_, residual_, q_;
};

}  // namespace

std::unique_ptr<Stepper> makeVariationalStepper(Law& law) { return std::make_unique<VariationalStepper>(law); }

}  // namespace dyn
