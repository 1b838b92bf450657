// The law of motion that steps are taken by: accelerations of a state under the callbacks' forces and the constraints.
#pragma once

#include <dyn/integrate/simulator.hpp>

#include <Eigen/Core>

#include <exception>
#include <optional>
#include <string>

namespace dyn {

[[noreturn]] void refuseCallback(const char* callback, double t, const std::string& why);

/// Calls what is the user's: whatever it throws becomes Error(simulation) with its name and the time.
template <class F>
void guardCallback(const char* callback, double t, F&& call) {
  try {
    call();
  } catch (const std::exception& e) {
    refuseCallback(callback, t, e.what());
  } catch (...) {
    refuseCallback(callback, t, "something that is no std::exception");
  }
}

class Law {
 public:
  Law(const CompactModel& model, const ConstraintSet* constraints, Need needs);

  /// Accelerations, valid until the next call. Throws Error(simulation) if a callback throws, Error(singular).
  const double* acceleration(double t, const double* q, const double* v);
  /// d ddq / d q and d ddq / d v at a state, through the callbacks too: nv x nv each. Needs Need::derivatives.
  void derivatives(double t, const double* q, const double* v, MatrixMap by_q, MatrixMap by_v);
  /// tau and forces of the callbacks, less J^T f, and joint_friction in place of the description's: what stands on the right of
  /// M ddq + C v + g + losses.
  const double* applied(double t, const double* q, const double* v);

  /// Largest forces of joints' Coulomb friction at q [N, N m], nv, followers' on their masters. Only of a model that has some.
  const Eigen::VectorXd& frictionLimits(const double* q);
  /// tau += what the model's own law of friction takes away at this velocity, so that it has none.
  void undoFriction(const double* q, const double* v, double* tau);

  /// [sqrt(J)] of velocities v at q: the root of their kinetic energy.
  double speed(const double* q, const double* v);
  double energy(const double* q, const double* v);
  /// [W] Of what is applied, less losses: the rate of energy().
  double power(double t, const double* q, const double* v);
  double constraintError(const double* q, const double* v);
  /// q and v onto what the constraints allow. False if q does not get there.
  bool project(double* q, double* v);
  void projectVelocity(const double* q, double* v);

  const CompactModel& model() const { return model_; }
  Data& data() { return data_; }
  bool constrained() const { return constraints_.has_value(); }
  /// Of a law that is.
  ConstraintData& constraints() { return *constraints_; }

  Controller controller;
  ControllerDerivatives controller_derivatives;
  Forces forces;
  SimulatorStatistics statistics;
  /// What joints' Coulomb friction is during a step [N, N m]: constant, so that steps are smooth. Empty: the model has none.
  Eigen::VectorXd joint_friction;
  /// [m/s^2, rad/s^2] Accelerations that it cancels where joints rest: of what is left of them rounding counts by this.
  double cancelled = 0;
  /// What a callback has given that is not finite, for a state that is, since this was cleared; else empty.
  std::string fault;

 private:
  /// tau_: what callbacks apply.
  void callBack(double t, const double* q, const double* v);
  void addFriction(const double* q, const double* v);
  void callController(double t, const double* q, const double* v, double* tau);
  void callForces(double t, const double* q, const double* v);
  bool atFiniteState(const double* q, const double* v) const { return configuration(q).allFinite() && velocity(v).allFinite(); }
  /// Of the state that callBack() was last called for: tau_ is what it is there, before and after.
  void differentiateController(double t, const double* q, const double* v);
  VectorResult configuration(const double* q) const { return {q, model_.nq()}; }
  VectorResult velocity(const double* v) const { return {v, model_.nv()}; }

  CompactModel model_;
  Data data_;
  std::optional<ConstraintData> constraints_;
  Eigen::VectorXd tau_, kept_tau_, friction_limits_, moved_q_, moved_v_, direction_, zero_;
  Eigen::MatrixXd tau_by_q_, tau_by_v_;
  ExternalForces fext_;
  std::vector<double> expanded_;  ///< nvx, of a model with friction
};

}  // namespace dyn
