// A model's motion through time.
//
//   dyn::Simulator simulator(model, {.integrator = dyn::Integrator::rk4, .dt = 1e-3});
//   simulator.reset(q, v);
//   simulator.setController([](double t, dyn::VectorResult q, dyn::VectorResult v, dyn::VectorMap tau) { tau = -10 * v; });
//   simulator.advance(2.0);
//
// The same inputs give the same bytes. After it is made a simulator of fixed steps allocates nothing; what callbacks do is theirs.
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

using VectorMap = Eigen::Map<Eigen::VectorXd>;
using MatrixMap = Eigen::Map<Eigen::MatrixXd>;

/// Writes tau (nv, zero before). Called at every evaluation of the dynamics, several times a step and not in the order of time: a function
/// of its arguments alone.
using Controller = std::function<void(double t, VectorResult q, VectorResult v, VectorMap tau)>;
/// Writes d tau / d q (in the tangent space) and d tau / d v, nv x nv each, zero before. Only speeds implicit integrators up, which take
/// differences without it.
using ControllerDerivatives = std::function<void(double t, VectorResult q, VectorResult v, MatrixMap dtau_dq, MatrixMap dtau_dv)>;
/// Writes external forces, one a joint, the universe included, in the joint's frame [N, N m] (zero before).
using Forces = std::function<void(double t, VectorResult q, VectorResult v, Force<double>* fext, int count)>;
using Observer = std::function<void(double t, VectorResult q, VectorResult v)>;

struct SimulatorOptions {
  Integrator integrator = Integrator::rk4;
  double dt = 1e-3;  ///< [s] of a step; of adaptive integrators the first that is tried
  /// Of adaptive integrators: error of a step, of configurations [m, rad] and of velocities [m/s, rad/s]. What steps add up to is about as much,
  /// and grows on as disturbances of the motion do.
  double tolerance = 1e-8;
  /// Constraints with a target are brought back to it after every step, velocities to what all constraints allow.
  bool project = true;
  bool limits = false;     ///< joints of one coordinate stop at the limits of position that the model gives
  double restitution = 0;  ///< of impacts with limits and contacts, in [0, 1]
};

/// Something that happens where a function of the state passes zero.
struct Event {
  enum class Direction { both, rising, falling };
  std::string name{};
  std::function<double(double t, VectorResult q, VectorResult v)> value{};
  Direction direction = Direction::both;
};

struct SimulatorStatistics {
  long steps = 0, rejected = 0;
  long evaluations = 0;       ///< of the accelerations
  long factorizations = 0;    ///< of implicit integrators' matrices
  long iterations = 0;        ///< of their equations
  long impacts = 0;           ///< answered with an impulse
  long touched = 0;           ///< contacts and limits that came to be touched, with an impulse or without
  long contact_steps = 0;     ///< in which something stayed in touch
  long inexact_contacts = 0;  ///< of both those whose forces iterations did not bring to the tolerance: the last of them were taken
};

/// One simulation, for one thread; it keeps its model alive. Its callbacks may read it, and may not step, reset or change it: Error(argument).
///
/// Coulomb friction of joints, if the model has it, acts against those that move, and holds those at rest as long as it can; what it cannot hold
/// starts to move. Steps end where a joint comes to rest. Those in which one is held are of second order at most, of adaptive integrators no
/// longer than dt. Memory is taken where joints come to rest.
class DYN_API Simulator {
 public:
  /// Of a model with the constraints of its own description, closed loops and couplings. Starts at neutral, at rest, at time 0. Throws
  /// Error(argument): a dt or tolerance that is not positive, joints that follow others with the variational integrator.
  explicit Simulator(const CompactModel& model, const SimulatorOptions& options = {});
  /// With these and no others.
  explicit Simulator(const ConstraintSet& constraints, const SimulatorOptions& options = {});
  ~Simulator();
  Simulator(Simulator&&) noexcept;
  Simulator& operator=(Simulator&&) noexcept;
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  const CompactModel& model() const;
  const SimulatorOptions& options() const;

  /// Throws Error(size | argument); Error(simulation) for numbers that are not finite.
  void reset(const VectorArg& q, const VectorArg& v, double time = 0) { resetTo(q, v, time); }
  void setController(Controller controller, ControllerDerivatives derivatives = nullptr);
  void setForces(Forces forces);
  /// What may touch, beside limits of joints: pointsOnPlane(), or geometryContacts() for bodies' volumes. Impacts are found in time; steps in
  /// which something stays in touch are of first order whatever the integrator, v + h (a + contacts' impulses) and then q (+) h v, of bodies that
  /// fly in axes that do not turn with them, and no longer than dt. What is inside of something is moved out over some steps, which gives it no
  /// speed. Contacts allocate where they come and go.
  void setContacts(ContactFinder finder);
  /// Functions whose zeros end advance(). They are looked for within each step, at seven places and where three of these tell of a zero between. Of
  /// events at one time each is told once: the second by the next call, which takes no time.
  void setEvents(std::vector<Event> events);

  double time() const;
  VectorResult q() const;
  VectorResult v() const;
  /// Accelerations at the present state; of joints that friction holds, those over the next dt.
  VectorResult acceleration();
  /// Kinetic and potential [J].
  double energy();
  /// Largest error of constraints with a target [m, rad].
  double constraintError();
  const SimulatorStatistics& statistics() const;
  /// Whether something stayed in touch during the last step: a contact or a limit.
  bool touches() const;

  /// One step; of adaptive integrators the next that keeps the tolerance. Throws Error(simulation) naming time, joint and what is wrong: a
  /// state that is not finite, a callback that throws or gives what is not finite, a step that collapses or that time does not resolve, equations
  /// without solution; of adaptive integrators 10,000 steps that lead less than dt / 10 further, as those of stiff motions do.
  /// The state is then that before.
  void step();
  /// To this time: whole steps, the last one as long as is left. Returns the index of the event that ended it sooner, or -1. Throws as step(),
  /// and Error(argument) for a time before the present one, or more than 2^40 steps of dt away by a method of fixed steps.
  int advance(double until) { return advanceTo(until, nullptr, 0, nullptr); }
  /// The same, and shows the states at `times` (ascending, none before the present one), which do not change how steps are taken: states
  /// between the ends of a step come from its polynomial.
  int advance(double until, const std::vector<double>& times, const Observer& observer) {
    return advanceTo(until, times.data(), times.size(), observer);
  }

  /// Time, state and step as text, without loss: resumed with the same options, the simulation goes on to the same bytes. Callbacks are not in it.
  std::string save() const;
  /// What the same integrator has saved, of any dt: whole steps of another one count from the saved time. Throws Error(syntax | size | argument),
  /// and Error(simulation) if an event's function throws; the simulator is then as it was.
  void resume(const std::string& saved);

  struct Impl;

 private:
  void resetTo(VectorView q, VectorView v, double time);
  int advanceTo(double until, const double* times, std::size_t count, const Observer& observer);

  Owned<Impl> impl_;
};

}  // namespace dyn
