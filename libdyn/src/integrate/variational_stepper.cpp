// SPDX-License-Identifier: BSD-2-Clause
// The variational integrator of the discrete Lagrangian L_d(q0, q1) = h L(q0 (+) h xi / 2, xi), q1 = q0 (+) h xi (Marsden and West 2001, sec.
// 1.3 and 3; on groups Bou-Rabee and Marsden 2009). In momenta p = M v, with F = C^T xi - g + forces the rate of p at the midpoint,
//   p0 = X^T p - h/2 Y0^T F,   p1 = X^T p + h/2 Y1^T F,   p = M(q) xi.
// The first equation is solved for xi, and the second gives p1. X, Y0, Y1 are 1 for coordinates that add; otherwise see Chart::midpointMaps.
// Constraints act at the ends (Andersen 1983, Leimkuhler and Skeel 1994; Marsden and West 2001, sec. 3.4): p0 + J(q0)^T lambda replaces p0, where
// lambda is such that q1 satisfies the constraints, and p1 is then such that J(q1) v1 = 0.
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

/// Broyden's method (1965; Kelley 1995, sec. 7): the changes of the corrections along the steps so far tell the error of the matrix that gave them.
/// For bodies that move farther in a step than their radius of gyration this error exceeds the matrix.
class Broyden {
 public:
  explicit Broyden(int n) : steps_(n, most) {}
  void start() { count_ = 0; }
  /// Turns a correction into the step of Broyden's method. Either is subtracted from the unknowns.
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
  explicit VariationalStepper(EquationsOfMotion& equations)
      : CubicStepper(equations),
        n_(equations.model().nv()),
        xi_(n_),
        u_(n_),
        momentum_(n_),
        start_momentum_(n_),
        rate_(n_),
        at_start_(n_),
        at_end_(n_),
        residual_(n_),
        q_(equations.model().nq()),
        broyden_(n_) {
    if (!equations.constrained()) return;
    const ConstraintSet& set = equations.constraints().set();
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
    accelerationAt(equations_, from);
    if (equations_.constrained())
      start_jacobian_ =
          MatrixResult(detail::constraintJacobian(equations_.model(), equations_.data(), {from.q.data(), from.q.size()}, equations_.constraints()),
                       start_jacobian_.rows(), n_);
    if (const StepOutcome outcome = solve(from, to); outcome != StepOutcome::taken) return outcome;
    massMatrix(to.q);
    cholesky::decompose(equations_.model(), equations_.data());
    to.v = momentum_ + 0.5 * h * at_end_;
    cholesky::solve(equations_.model(), equations_.data(), to.v);
    if (equations_.constrained()) equations_.projectVelocity(to.q.data(), to.v.data());
    to.has_acceleration = false;
    return StepOutcome::taken;
  }

 private:
  MatrixResult massMatrix(const Eigen::VectorXd& q) { return crba(equations_.model(), equations_.data(), q); }

  /// Solves for xi with M at the midpoint as the matrix of Newton's method; the error of this matrix is of the order of h.
  StepOutcome solve(const Moment& from, Moment& to) {
    constexpr int most_iterations = 200;
    // Bounds of rounding errors. Constraints depend on positions, whose rounding errors count divided by the step's length.
    const double floor = equations_.constrained() ? 0x1p-30 : 0x1p-40;
    const double far_off = equations_.constrained() && n_ > 0 ? 0x1p-50 * from.q.cwiseAbs().maxCoeff() / h_ : 0;
    broyden_.start();
    start_momentum_.noalias() = massMatrix(from.q) * from.v;
    xi_ = from.v + 0.5 * h_ * from.a;
    double before = std::numeric_limits<double>::infinity();
    int no_better = 0;
    for (int i = 0; i < most_iterations; ++i) {
      ++equations_.statistics.iterations;
      evaluate(from, to);
      residual_ = momentum_ - 0.5 * h_ * at_start_ - start_momentum_;
      cholesky::solve(equations_.model(), equations_.data(), residual_);
      if (equations_.constrained()) constrain();
      const double size = n_ > 0 ? residual_.cwiseAbs().maxCoeff() : 0;
      const double scale = n_ > 0 ? std::max(xi_.cwiseAbs().maxCoeff(), h_ * equations_.cancelled) : 0;
      if (!residual_.allFinite()) return StepOutcome::not_finite;
      const bool solved = size <= rounding(0x1p-52, scale) || (size > 0.5 * before && size <= rounding(floor, scale) + far_off);
      // Constraint forces are further unknowns, so Broyden's method is not used with constraints.
      if (!solved && !equations_.constrained()) broyden_.improve(residual_);
      xi_ -= residual_;
      if (solved) break;
      no_better = size > before ? no_better + 1 : 0;
      if (no_better == 5 || i + 1 == most_iterations) return StepOutcome::unsolved;
      before = size;
    }
    evaluate(from, to);
    return StepOutcome::taken;
  }

  /// Changes the correction of xi and the momentum at the start by the constraint forces that make q1 satisfy the constraints. The matrix is that at
  /// the midpoint, where it is most accurate: near singular positions rows change quickly.
  void constrain() {
    ConstraintDataImpl& c = equations_.constraints().impl();
    const CompactImpl& m = equations_.model().impl();
    const int rows = c.set.rows();
    // -residual + X lambda must change the rows' velocities by -violation.
    for (int r = 0; r < rows; ++r) c.wanted[r] = -(placed_[static_cast<std::size_t>(r)] ? violation_[r] : c.motion.velocity[r]);
    addRowsOf(m, c, residual_.data(), c.wanted);
    c.solver.factor(c.workspace, equations_.constraints().settings);
    c.solver.solve(c.wanted, c.lambda);
    start_momentum_.noalias() += start_jacobian_.transpose().lazyProduct(VectorResult(c.lambda, rows));
    for (int r = 0; r < rows; ++r) c.lambda[r] = -c.lambda[r];
    addMotionOf(m, c, c.lambda, residual_.data());
  }

  /// Computes momentum_ = X^T p and the forces at both ends for the present xi. The data then holds the factors of M at the midpoint.
  void evaluate(const Moment& from, Moment& to) {
    const CompactModel& model = equations_.model();
    Data& data = equations_.data();
    u_ = h_ * xi_;
    chart_.point(from.q.data(), u_.data(), to.q.data());
    u_ *= 0.5;
    chart_.point(from.q.data(), u_.data(), q_.data());
    u_ *= 2;
    if (equations_.constrained()) violate(to);
    // F = (C + C^T) xi - (C xi + g + dissipation) + applied forces: gravity and dissipation come from rnea alone.
    rate_ = VectorResult(equations_.applied(from.time + 0.5 * h_, q_.data(), xi_.data()), n_);
    rate_ -= nonLinearEffects(model, data, q_, xi_);
    const MatrixResult C = computeCoriolisMatrix(model, data, q_, xi_);
    rate_.noalias() += C * xi_;
    rate_.noalias() += C.transpose() * xi_;
    if (equations_.constrained()) {
      const VectorView xi{xi_.data(), n_};
      projectInertia("Simulator::step", model, data, {q_.data(), q_.size()}, &xi, equations_.constraints().impl());
      momentum_.noalias() = MatrixResult(data.impl().M, n_, n_) * xi_;
    } else {
      momentum_.noalias() = massMatrix(q_) * xi_;
      cholesky::decompose(model, data);
    }
    chart_.midpointMaps(u_.data(), momentum_.data(), rate_.data(), at_start_.data(), at_end_.data());
  }

  /// Computes violation_, the constraints' errors at q1 divided by h. Constraints without a target ask for zero velocity at the midpoint instead.
  void violate(const Moment& to) {
    const VectorView q{to.q.data(), to.q.size()}, xi{xi_.data(), n_};
    violation_ =
        VectorResult(detail::constraintMotion(equations_.model(), equations_.data(), q, xi, equations_.constraints()).error, violation_.size()) / h_;
  }

  int n_;
  Eigen::MatrixXd start_jacobian_;
  Eigen::VectorXd violation_;
  std::vector<bool> placed_;  ///< by row: true if its constraint has a target
  Eigen::VectorXd xi_, u_, momentum_, start_momentum_, rate_, at_start_, at_end_, residual_, q_;
  Broyden broyden_;
};

}  // namespace

std::unique_ptr<Stepper> makeVariationalStepper(EquationsOfMotion& equations) { return std::make_unique<VariationalStepper>(equations); }

}  // namespace dyn
