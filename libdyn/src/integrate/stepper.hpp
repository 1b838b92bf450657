// One step of a method, and the motion between its ends.
#pragma once

#include "integrate/chart.hpp"
#include "integrate/law.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace dyn {

/// A state at its time, and the accelerations there, if they are known.
struct Moment {
  double time = 0;
  Eigen::VectorXd q, v, a;
  bool has_acceleration = false;

  explicit Moment(const CompactModel& model) : q(model.nq()), v(model.nv()), a(model.nv()) {}
};

/// The law's accelerations there, computed unless they are known.
const double* accelerationAt(Law& law, Moment& x);

enum class StepOutcome {
  taken,
  not_finite,
  unsolved,  ///< the step's equations have no solution near, or iterations do not reach it
};

/// What rounding may leave of a number of this size, where numbers have this relative resolution; the smallest normal number at least, below which
/// they have none.
inline double rounding(double relative, double size) { return std::max(relative * size, std::numeric_limits<double>::min()); }

class Stepper {
 public:
  virtual ~Stepper() = default;

  /// From `from` by h to `to`, whose time is set.
  virtual StepOutcome step(double h, Moment& from, Moment& to) = 0;
  /// Error of the last step in units of what the tolerance allows it; 0 for methods without an estimate.
  virtual double error() const { return 0; }
  /// The degree of freedom that this is of.
  virtual int worst() const { return 0; }
  /// The state at the share theta of the last step, to about the method's order but no better than the fourth. `to` may have
  /// been projected since.
  virtual void between(double theta, Moment& from, Moment& to, double* q, double* v) = 0;
};

std::unique_ptr<Stepper> makeStepper(Law& law, const SimulatorOptions& options);

// One factory a family of methods, for makeStepper.
std::unique_ptr<Stepper> makeEulerStepper(Law& law, bool semi_implicit);
std::unique_ptr<Stepper> makeExplicitStepper(Law& law, const SimulatorOptions& options);
std::unique_ptr<Stepper> makeCollocationStepper(Law& law, Integrator integrator);
std::unique_ptr<Stepper> makeVariationalStepper(Law& law);

/// The cubics through the ends of a step with their velocities and accelerations, in the chart about its start.
class CubicStepper : public Stepper {
 public:
  explicit CubicStepper(Law& law);
  void between(double theta, Moment& from, Moment& to, double* q, double* v) override;

 protected:
  Law& law_;
  Chart chart_;
  double h_ = 0;  ///< the last step

 private:
  Eigen::VectorXd u_, rate_;
};

}  // namespace dyn
