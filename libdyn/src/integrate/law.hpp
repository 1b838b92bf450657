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
  /// tau and forces of the callbacks, less J^T f: what stands on the right of M ddq + C v + g.
  const double* applied(double t, const double* q, const double* v);

  double energy(const double* q, const double* v);
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

 private:
  void callController(double t, const double* q, const double* v, double* tau);
  void callForces(double t, const double* q, const double* v);
  /// Of the state that applied() was last called for: tau_ is what it is there, before and after.
  void differentiateController(double t, const double* q, const double* v);
  VectorResult configuration(const double* q) const { return {q, model_.nq()}; }
  VectorResult velocity(const double* v) const { return {v, model_.nv()}; }

  CompactModel model_;
  Data data_;
  std::optional<ConstraintData> constraints_;
  Eigen::VectorXd tau_, kept_tau_, moved_q_, moved_v_, direction_, zero_;
  Eigen::MatrixXd tau_by_q_, tau_by_v_;
  ExternalForces fext_;
};

}  // namespace dyn
