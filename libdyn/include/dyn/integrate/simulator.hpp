// SPDX-License-Identifier: BSD-2-Clause
// Simulation of a model.
#pragma once

#include <dyn/algorithm/rnea.hpp>
#include <dyn/constraint/constraint_set.hpp>
#include <dyn/integrate/contacts.hpp>
#include <dyn/integrate/integrator.hpp>
#include <dyn/owned.hpp>

#include <functional>
#include <string>
#include <vector>

namespace dyn {

/// A vector or matrix in memory of the simulator, to which a callback writes.
/// @{
using VectorMap = Eigen::Map<Eigen::VectorXd>;
using MatrixMap = Eigen::Map<Eigen::MatrixXd>;
/// @}

/// Writes tau [N m, N] (nv numbers, zero before). The simulator calls it at every evaluation of the dynamics, several times a step and not in the
/// order of time, so it must be a function of its arguments alone.
using Controller = std::function<void(double t, VectorResult q, VectorResult v, VectorMap tau)>;
/// Writes d tau / d q (in the tangent space) and d tau / d v, nv x nv each, zero before. This only makes implicit integrators faster: without it, or
/// with setForces(), they take differences.
using ControllerDerivatives = std::function<void(double t, VectorResult q, VectorResult v, MatrixMap dtau_dq, MatrixMap dtau_dv)>;
/// Writes external forces, one for each joint, the universe included, in the joint's frame [N, N m] (zero before).
using Forces = std::function<void(double t, VectorResult q, VectorResult v, Force<double>* fext, int count)>;
/// Reads a state that advance() passes.
using Observer = std::function<void(double t, VectorResult q, VectorResult v)>;

/// How a simulation steps.
struct SimulatorOptions {
  Integrator integrator = Integrator::rk4;  ///< integration method
  double dt = 1e-3;                         ///< [s] length of a step; for adaptive integrators that of the first step tried
  /// For adaptive integrators: largest error of a step, in configurations [m, rad] and in velocities [m/s, rad/s]. The global error is of the same
  /// order and grows as the motion amplifies disturbances.
  double tolerance = 1e-8;
  /// After every step, projects the configuration onto constraints with a target, and velocities onto those that all constraints allow.
  bool project = true;
  bool limits = false;     ///< joints of one coordinate stop at the position limits of the model
  double restitution = 0;  ///< of impacts with limits and contacts, in [0, 1]
};

/// An event that advance() reports: a function of the state passes zero.
struct Event {
  /// The changes of sign that count: all, those from negative to positive, or those from positive to negative.
  enum class Direction { both, rising, falling };
  std::string name{};                                                       ///< used in messages
  std::function<double(double t, VectorResult q, VectorResult v)> value{};  ///< the function; it must not be empty
  Direction direction = Direction::both;                                    ///< which changes of sign count
};

/// Numbers of what a simulation has done since its start, or the last reset or resume.
struct SimulatorStatistics {
  long steps = 0,             ///< steps taken
      rejected = 0;           ///< steps that were too long and repeated with a shorter length
  long evaluations = 0;       ///< of the accelerations
  long factorizations = 0;    ///< of implicit integrators' matrices
  long iterations = 0;        ///< of their equations
  long impacts = 0;           ///< impacts resolved with an impulse
  long touched = 0;           ///< contacts and limits newly touched, with or without an impulse
  long contact_steps = 0;     ///< steps in which something stayed in contact
  long inexact_contacts = 0;  ///< solutions for contacts or joint friction that did not reach the tolerance; the last iterates were used
};

/// One simulation, for one thread. It keeps its model alive. Its callbacks may read it; a callback that steps, resets or changes it gets
/// Error(argument).
///
///     dyn::Simulator simulator(model, {.integrator = dyn::Integrator::rk4, .dt = 1e-3});
///     simulator.reset(q, v);
///     simulator.setController([](double t, dyn::VectorResult q, dyn::VectorResult v, dyn::VectorMap tau) { tau = -10 * v; });
///     simulator.advance(2.0);
///
/// The same inputs give the same bytes. After its construction, a simulator with fixed steps allocates nothing without contacts and joint friction,
/// except what its callbacks allocate.
///
/// Coulomb friction of joints, if the model has it, opposes joints that move and holds joints at rest as long as it can; a joint that it cannot hold
/// starts to move. Steps end where a joint comes to rest. Steps in which a joint is held are of second order at most, and with adaptive integrators
/// no longer than dt. Memory is allocated when joints come to rest.
class DYN_API Simulator {
 public:
  /// Simulates a model with the constraints of its own description (closed loops and couplings). Starts at neutral, at rest, at time 0. Throws
  /// Error(argument) for a dt or tolerance that is not positive, a restitution outside [0, 1], and with the variational integrator for dependent
  /// joints and for joints whose v is not dq/dt (own_rates).
  explicit Simulator(const CompactModel& model, const SimulatorOptions& options = {});
  /// Simulates the model of `constraints` with these constraints and no others.
  explicit Simulator(const ConstraintSet& constraints, const SimulatorOptions& options = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// Returns the model, or the options given to the constructor.
  /// @{
  const CompactModel& model() const;
  const SimulatorOptions& options() const;
  /// @}

  /// Sets state and time, and the statistics to zero. Throws Error(size | argument), and Error(simulation) for numbers that are not finite.
  void reset(const VectorArg& q, const VectorArg& v, double time = 0) { resetTo(q, v, time); }
  /// Sets the function that computes tau, with its derivatives if they are known. An empty function means tau = 0. Throws Error(argument) in a
  /// callback.
  void setController(Controller controller, ControllerDerivatives derivatives = nullptr);
  /// Sets the function that computes external forces. An empty function means that there are none. Throws Error(argument) in a callback.
  void setForces(Forces forces);
  /// Sets the finder of contacts, in addition to joint limits: pointsOnPlane(), or geometryContacts() for volumes on bodies. Impacts are located in
  /// time. A contact step, in which something stays in contact, is of first order with every integrator and no longer than dt: v + h (a + contacts'
  /// impulses), then q (+) h v, for floating bases in axes that do not turn with them. Penetration is undone over several steps, which adds no speed.
  /// Memory is allocated when contacts come and go.
  void setContacts(ContactFinder finder);
  /// Sets functions whose zeros end advance(). Each step is searched at seven states, and between them where three of these indicate a zero. Several
  /// events at one time are reported once each: the next call of advance() reports the second and takes no time. Throws Error(argument) for an event
  /// without a function and in a callback, and Error(simulation) if a function throws.
  void setEvents(std::vector<Event> events);

  /// Returns the present time [s], configuration (nq) or velocity (nv) [rad/s, m/s]. Views are valid until the simulator steps or is reset.
  /// @{
  double time() const;
  VectorResult q() const;
  VectorResult v() const;
  /// @}
  /// Returns the accelerations at the present state, nv numbers [rad/s^2, m/s^2]. Joints that friction holds have their acceleration over the next
  /// dt.
  VectorResult acceleration();
  /// Returns the kinetic plus potential energy [J].
  double energy();
  /// Returns the largest position error of constraints with a target [m, rad]; 0 without constraints.
  double constraintError();
  /// Returns the numbers of steps, evaluations and so on since the start, or the last reset or resume.
  const SimulatorStatistics& statistics() const;
  /// Returns whether a contact or a limit stayed in contact during the last step.
  bool touches() const;

  /// Takes one step; an adaptive integrator takes the next step that keeps the tolerance. Throws Error(simulation), naming time, joint and cause: a
  /// state that is not finite, a callback that throws or returns a number that is not finite, a step that collapses or is too short to change the
  /// time, equations without solution, and for adaptive integrators 10,000 steps that together advance less than dt / 10, as in stiff motion.
  /// After an error the state is as before the step.
  void step();
  /// Advances to this time in whole steps; the last step takes what is left. Returns the index of the event that ended it sooner, or -1. Throws as
  /// step(), and Error(argument) for a time before the present one, or more than 2^40 fixed steps away.
  int advance(double until) { return advanceTo(until, nullptr, 0, nullptr); }
  /// Does the same, and calls the observer with the states at `times` (ascending, from the present time to `until`). This does not change the steps:
  /// states within a step come from its polynomial.
  int advance(double until, const std::vector<double>& times, const Observer& observer) {
    return advanceTo(until, times.data(), times.size(), observer);
  }

  /// Returns time, state and step as text, without loss: a simulation resumed with the same options gives the same bytes. Callbacks are not saved.
  std::string save() const;
  /// Goes on from a state that the same integrator has saved for the same model, with any dt; with another dt, whole steps count from the saved time.
  /// Throws Error(syntax | size | argument), and Error(simulation) if an event's function throws; the simulator is then unchanged.
  void resume(const std::string& saved);

  struct Impl;

 private:
  void resetTo(VectorView q, VectorView v, double time);
  int advanceTo(double until, const double* times, std::size_t count, const Observer& observer);

  Owned<Impl> impl_;
};

}  // namespace dyn
