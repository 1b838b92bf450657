// SPDX-License-Identifier: BSD-2-Clause
// Interface of an integration method: one step, and the motion between its ends.
#pragma once

#include "integrate/chart.hpp"
#include "integrate/equations_of_motion.hpp"

#include <algorithm>
#include <limits>
#include <memory>

namespace dyn {

/// A state, its time, and its accelerations if they are known.
struct Moment {
  double time = 0;
  Eigen::VectorXd q, v, a;
  bool has_acceleration = false;

  explicit Moment(const CompactModel& model) : q(model.nq()), v(model.nv()), a(model.nv()) {}
};

/// Returns the accelerations of x, and computes them unless they are known.
const double* accelerationAt(EquationsOfMotion& equations, Moment& x);

enum class StepOutcome {
  taken,
  not_finite,
  unsolved,  ///< the step's equations have no solution nearby, or the iterations do not reach it
};

/// Returns the rounding error of a number of this size at this relative resolution. It is at least the smallest normal number, below which numbers
/// have no relative resolution.
inline double rounding(double relative, double size) { return std::max(relative * size, std::numeric_limits<double>::min()); }

class Stepper {
 public:
  virtual ~Stepper() = default;

  /// Steps from `from` by h to `to`, whose time is already set.
  virtual StepOutcome step(double h, Moment& from, Moment& to) = 0;
  /// Returns the last step's error divided by the error that the tolerance allows; 0 for methods without an estimate.
  virtual double error() const { return 0; }
  /// Returns the degree of freedom that has this error.
  virtual int worst() const { return 0; }
  /// Computes the state at the fraction theta of the last step, to about the method's order but at most the fourth. `to` may have been projected
  /// since.
  virtual void between(double theta, Moment& from, Moment& to, double* q, double* v) = 0;
};

std::unique_ptr<Stepper> makeStepper(EquationsOfMotion& equations, const SimulatorOptions& options);

// makeStepper calls these factories, one for each family of methods.
std::unique_ptr<Stepper> makeEulerStepper(EquationsOfMotion& equations, bool semi_implicit);
std::unique_ptr<Stepper> makeExplicitStepper(EquationsOfMotion& equations, const SimulatorOptions& options);
std::unique_ptr<Stepper> makeCollocationStepper(EquationsOfMotion& equations, Integrator integrator);
std::unique_ptr<Stepper> makeVariationalStepper(EquationsOfMotion& equations);

/// Interpolates a step by cubics through its ends, with their velocities and accelerations, in the chart about its start.
class CubicStepper : public Stepper {
 public:
  explicit CubicStepper(EquationsOfMotion& equations);
  void between(double theta, Moment& from, Moment& to, double* q, double* v) override;

 protected:
  EquationsOfMotion& equations_;
  Chart chart_;
  double h_ = 0;  ///< length of the last step

 private:
  Eigen::VectorXd u_, rate_;
};

}  // namespace dyn
