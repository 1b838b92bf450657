// The variational integrator of the discrete Lagrangian L_d(q0, q1) = h L(q0 (+) h xi / 2, xi), q1 = q0 (+) h xi (Marsden and West 2001, sec.
// 1.3 and 3; on groups Bou-Rabee and Marsden 2009). In momenta p = M v, with F = C^T xi - g + forces the rate of p at the midpoint,
//   p0 = X^T p - h/2 Y0^T F,   p1 = X^T p + h/2 Y1^T F,   p = M(q) xi:
// the first is solved for xi, the second gives p1. X, Y0, Y1 are 1 for coordinates that add; otherwise see Chart::midpointMaps.
// Constraints act at the ends (Andersen 1983, Leimkuhler and Skeel 1994; Marsden and West 2001, sec. 3.4): p0 + J(q0)^T lambda in place of p0,
// with lambda such that q1 keeps them, and p1 then such that J(q1) v1 = 0.
#include "constraint/kkt.hpp"
#include "integrate/stepper.hpp"

#include <dyn/algorithm/cholesky.hpp>
#include <dyn/algorithm/coriolis.hpp>
#include <dyn/algorithm/crba.hpp>
#include <dyn/constraint/dynamics.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace dyn {

namespace {

/// Broyden's method (1965; Kelley 1995, sec. 7): how corrections have changed along the steps so far tells what the matrix that they were found with
/// lacks. For bodies that fly further in a step than their radius of gyration that is more than it has.
class Broyden {
 public:
  explicit Broyden(int n) : steps_(n, most) {}
  void start() { count_ = 0; }
  /// A correction, to be subtracted from the unknowns, becomes the step that is.
  void improve(Eigen::VectorXd& x) {
    for (int k = 1; k < count_; ++k) x += steps_.col(k) * (steps_.col(k - 1).dot(x) / steps_.col(k - 1).squaredNorm());
    if (count_ > 0) {
      const double left = 1 - steps_.col(count_ - 1).dot(x) / steps_.col(count_ - 1).squaredNorm();
      if (count_ < most && std::abs(left) > 0x1p-6) {
        x /= left;
      } else {
        count_ = 0;
      }
    }
    steps_.col(count_++) = x;
  }

 private:
  static constexpr int most = 24;
  Eigen::MatrixXd steps_;
  int count_ = 0;
};

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
        q_(law.model().nq()),
        broyden_(n_) {
    if (!law.constrained()) return;
    const ConstraintSet& set = law.constraints().set();
    start_jacobian_.resize(set.rows(), n_);
    violation_.resize(set.rows());
    for (int k = 0; k < set.count(); ++k) {
      const auto& relation = set.description(k).relation;
      const auto* frame = std::get_if<FrameConstraint>(&relation);
      const auto* lock = std::get_if<JointLock>(&relation);
      const bool placed = !(frame && !frame->has_target) && !(lock && lock->configuration.empty());
      placed_.insert(placed_.end(), static_cast<std::size_t>(set.rows(k)), placed);
    }
  }

  StepOutcome step(double h, Moment& from, Moment& to) override {
    h_ = h;
    accelerationAt(law_, from);
    if (law_.constrained())
      start_jacobian_ = MatrixResult(detail::constraintJacobian(law_.model(), law_.data(), {from.q.data(), from.q.size()}, law_.constraints()),
                                     start_jacobian_.rows(), n_);
    if (const StepOutcome outcome = solve(from, to); outcome != StepOutcome::taken) return outcome;
    massMatrix(to.q);
    cholesky::decompose(law_.model(), law_.data());
    to.v = momentum_ + 0.5 * h * at_end_;
    cholesky::solve(law_.model(), law_.data(), to.v);
    if (law_.constrained()) law_.projectVelocity(to.q.data(), to.v.data());
    to.has_acceleration = false;
    return StepOutcome::taken;
  }

 private:
  MatrixResult massMatrix(const Eigen::VectorXd& q) { return crba(law_.model(), law_.data(), q); }

  /// M at the midpoint is the matrix: what it lacks is of the order of h.
  StepOutcome solve(const Moment& from, Moment& to) {
    constexpr int most_iterations = 200;
    // Rounding: that of positions, which constraints look at, counts by the step's length.
    const double floor = law_.constrained() ? 0x1p-30 : 0x1p-40;
    const double far_off = law_.constrained() && n_ > 0 ? 0x1p-50 * from.q.cwiseAbs().maxCoeff() / h_ : 0;
    broyden_.start();
    start_momentum_.noalias() = massMatrix(from.q) * from.v;
    xi_ = from.v + 0.5 * h_ * from.a;
    double before = std::numeric_limits<double>::infinity();
    int no_better = 0;
    for (int i = 0; i < most_iterations; ++i) {
      ++law_.statistics.iterations;
      evaluate(from, to);
      residual_ = momentum_ - 0.5 * h_ * at_start_ - start_momentum_;
      cholesky::solve(law_.model(), law_.data(), residual_);
      if (law_.constrained()) constrain();
      const double size = n_ > 0 ? residual_.cwiseAbs().maxCoeff() : 0;
      const double scale = n_ > 0 ? std::max(xi_.cwiseAbs().maxCoeff(), h_ * law_.cancelled) : 0;
      if (!residual_.allFinite()) return StepOutcome::not_finite;
      const bool solved = size <= rounding(0x1p-52, scale) || (size > 0.5 * before && size <= rounding(floor, scale) + far_off);
      // Constraints' forces are unknowns beside.
      if (!solved && !law_.constrained()) broyden_.improve(residual_);
      xi_ -= residual_;
      if (solved) break;
      no_better = size > before ? no_better + 1 : 0;
      if (no_better == 5 || i + 1 == most_iterations) return StepOutcome::unsolved;
      before = size;
    }
    evaluate(from, to);
    return StepOutcome::taken;
  }

  /// Changes the correction of xi and the momentum at the start by the forces that bring q1 to where the constraints hold. The matrix is that
  /// halfway, where it lacks least: near singular positions rows change quickly.
  void constrain() {
    ConstraintDataImpl& c = law_.constraints().impl();
    const CompactImpl& m = law_.model().impl();
    const int rows = c.set.rows();
    // -residual + X lambda is to change the rows' velocities by -violation.
    for (int r = 0; r < rows; ++r) c.wanted[r] = -(placed_[static_cast<std::size_t>(r)] ? violation_[r] : c.motion.velocity[r]);
    addRowsOf(m, c, residual_.data(), c.wanted);
    c.solver.factor(c.workspace, law_.constraints().settings);
    c.solver.solve(c.wanted, c.lambda);
    start_momentum_.noalias() += start_jacobian_.transpose().lazyProduct(VectorResult(c.lambda, rows));
    for (int r = 0; r < rows; ++r) c.lambda[r] = -c.lambda[r];
    addMotionOf(m, c, c.lambda, residual_.data());
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
    if (law_.constrained()) violate(to);
    // F = (C + C^T) xi - (C xi + g + losses) + applied forces: gravity and losses come from rnea alone.
    rate_ = VectorResult(law_.applied(from.time + 0.5 * h_, q_.data(), xi_.data()), n_);
    rate_ -= nonLinearEffects(model, data, q_, xi_);
    const MatrixResult C = computeCoriolisMatrix(model, data, q_, xi_);
    rate_.noalias() += C * xi_;
    rate_.noalias() += C.transpose() * xi_;
    if (law_.constrained()) {
      const VectorView xi{xi_.data(), n_};
      projectInertia("Simulator::step", model, data, {q_.data(), q_.size()}, &xi, law_.constraints().impl());
      momentum_.noalias() = MatrixResult(data.impl().M, n_, n_) * xi_;
    } else {
      momentum_.noalias() = massMatrix(q_) * xi_;
      cholesky::decompose(model, data);
    }
    chart_.midpointMaps(u_.data(), momentum_.data(), rate_.data(), at_start_.data(), at_end_.data());
  }

  /// By which q1 does not keep the constraints, as velocities over the step. Those without a place to keep ask for no velocity halfway.
  void violate(const Moment& to) {
    const VectorView q{to.q.data(), to.q.size()}, xi{xi_.data(), n_};
    violation_ = VectorResult(detail::constraintMotion(law_.model(), law_.data(), q, xi, law_.constraints()).error, violation_.size()) / h_;
  }

  int n_;
  Eigen::MatrixXd start_jacobian_;
  Eigen::VectorXd violation_;
  std::vector<bool> placed_;  ///< by row: whether its constraint has a target
  Eigen::VectorXd xi_, u_, momentum_, start_momentum_, rate_, at_start_, at_end_, residual_, q_;
  Broyden broyden_;
};

}  // namespace

std::unique_ptr<Stepper> makeVariationalStepper(Law& law) { return std::make_unique<VariationalStepper>(law); }

}  // namespace dyn
