// SPDX-License-Identifier: BSD-2-Clause
// The equations of motion that the steppers integrate: accelerations of a state under the callbacks' forces and the constraints.
#pragma once

#include <dyn/integrate/simulator.hpp>

#include <Eigen/Core>

#include <exception>
#include <optional>
#include <string>

namespace dyn {

[[noreturn]] void refuseCallback(const char* callback, double t, const std::string& why);

/// Calls a user's callback. Anything that it throws becomes Error(simulation) with the callback's name and the time.
template <class F>
void guardCallback(const char* callback, double t, F&& call) {
  try {
    call();
  } catch (const std::exception& e) {
    refuseCallback(callback, t, e.what());
  } catch (...) {
    refuseCallback(callback, t, "something that is no exception of the standard library");
  }
}

class EquationsOfMotion {
 public:
  EquationsOfMotion(const CompactModel& model, const ConstraintSet* constraints, Need needs);

  /// Returns the accelerations (nv), valid until the next call. Throws Error(simulation) if a callback throws, and Error(singular).
  const double* acceleration(double t, const double* q, const double* v);
  /// Writes d ddq / d q and d ddq / d v at a state, nv x nv each, including the callbacks' derivatives. Needs Need::derivatives.
  void derivatives(double t, const double* q, const double* v, MatrixMap by_q, MatrixMap by_v);
  /// Returns the right-hand side of M ddq + C v + g + dissipation (nv): tau of the controller, the generalised external forces, and joint_friction in
  /// place of the model's own Coulomb friction. Constraint forces are not in it.
  const double* applied(double t, const double* q, const double* v);

  /// Returns the largest forces of the joints' Coulomb friction at q [N, N m] (nv). Dependent joints' friction is added to that of their masters.
  /// Only for a model with friction.
  const Eigen::VectorXd& frictionLimits(const double* q);
  /// Adds to tau what the model's own Coulomb friction takes away at this velocity, so that the friction cancels.
  void undoFriction(const double* q, const double* v, double* tau);

  /// Returns the square root of the kinetic energy of v at q [sqrt(J)].
  double speed(const double* q, const double* v);
  /// Returns the kinetic and potential energy [J].
  double energy(const double* q, const double* v);
  /// Returns the power of the applied forces less dissipation [W], which is the rate of energy().
  double power(double t, const double* q, const double* v);
  double constraintError(const double* q, const double* v);
  /// Projects q and v onto the constraints. Returns false if q does not reach them.
  bool project(double* q, double* v);
  void projectVelocity(const double* q, double* v);

  const CompactModel& model() const { return model_; }
  Data& data() { return data_; }
  bool constrained() const { return constraints_.has_value(); }
  /// Only if constrained().
  ConstraintData& constraints() { return *constraints_; }

  Controller controller;
  ControllerDerivatives controller_derivatives;
  Forces forces;
  SimulatorStatistics statistics;
  /// Force of the joints' Coulomb friction during a step [N, N m] (nv): constant, so that steps are smooth. Empty if the model has none.
  Eigen::VectorXd joint_friction;
  /// Largest acceleration that friction cancels at resting joints [m/s^2, rad/s^2]. Rounding errors of what is left are relative to it.
  double cancelled = 0;
  /// Describes the first number that is not finite and that a callback gave for a finite state since this was cleared; else empty.
  std::string fault;

 private:
  /// Sets tau_ to the generalised forces of the callbacks.
  void callBack(double t, const double* q, const double* v);
  void addFriction(const double* q, const double* v);
  void callController(double t, const double* q, const double* v, double* tau);
  void callForces(double t, const double* q, const double* v);
  bool atFiniteState(const double* q, const double* v) const { return configuration(q).allFinite() && velocity(v).allFinite(); }
  /// Differentiates callBack() at the state of its last call. tau_ is the value at that state, before and after.
  void differentiateController(double t, const double* q, const double* v);
  VectorResult configuration(const double* q) const { return {q, model_.nq()}; }
  VectorResult velocity(const double* v) const { return {v, model_.nv()}; }

  CompactModel model_;
  Data data_;
  std::optional<ConstraintData> constraints_;
  Eigen::VectorXd tau_, kept_tau_, friction_limits_, moved_q_, moved_v_, direction_, zero_;
  Eigen::MatrixXd tau_by_q_, tau_by_v_;
  ExternalForces fext_;
  std::vector<double> expanded_;  ///< nvx; only for a model with friction
};

}  // namespace dyn
