// SPDX-License-Identifier: BSD-2-Clause
#include "algorithm/support/inputs.hpp"
#include "integrate/simulator_impl.hpp"
#include "number_text.hpp"

#include <dyn/algorithm/configuration.hpp>
#include <dyn/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace dyn {

namespace {

[[noreturn]] void refuse(const std::string& why) { throw Error(ErrorCode::argument, "Simulator: " + why); }

const SimulatorOptions& checked(const CompactModel& model, const SimulatorOptions& options) {
  if (!(options.restitution >= 0 && options.restitution <= 1)) refuse("restitution is " + number(options.restitution) + "; it is between 0 and 1");
  if (!(options.dt > 0) || !std::isfinite(options.dt)) refuse("dt is " + number(options.dt) + "; a step of time must be positive");
  if (!(options.tolerance > 0)) refuse("the tolerance is " + number(options.tolerance) + "; it must be positive");
  if (options.integrator == Integrator::variational && !model.impl().couplings.empty())
    refuse("the integrator 'variational' takes no joints that follow others; load them as independent ones, or use implicit_midpoint");
  if (options.integrator == Integrator::variational)
    for (const TypeBatch& batch : model.impl().batches)
      if (batch.curved)
        refuse(std::string("the integrator 'variational' takes no joints whose velocities are not rates of their coordinates, as those of type '") +
               batch.type->info().name + "' are not; use implicit_midpoint");
  return options;
}

Need needOf(Integrator integrator) { return infoOf(integrator).implicit ? Need::derivatives : Need::state; }

}  // namespace

std::unique_ptr<Stepper> makeStepper(EquationsOfMotion& equations, const SimulatorOptions& options) {
  switch (options.integrator) {
    case Integrator::explicit_euler:
      return makeEulerStepper(equations, false);
    case Integrator::semi_implicit_euler:
      return makeEulerStepper(equations, true);
    case Integrator::rk4:
    case Integrator::dormand_prince:
      return makeExplicitStepper(equations, options);
    case Integrator::implicit_midpoint:
    case Integrator::gauss6:
    case Integrator::radau5:
      return makeCollocationStepper(equations, options.integrator);
    case Integrator::variational:
      return makeVariationalStepper(equations);
  }
  refuse("there is no such integrator");
}

Simulator::Impl::Impl(const CompactModel& model, const ConstraintSet* set, const SimulatorOptions& o)
    : options(checked(model, o)),
      constraints(set ? std::optional(*set) : std::nullopt),
      equations(model, set, needOf(o.integrator)),
      stepper(makeStepper(equations, options)),
      now(model),
      next(model),
      shown_q(model.nq()),
      shown_v(model.nv()),
      trial(o.dt),
      after_impact(model.nv()),
      contact_u(model.nv()),
      contact_v(model.nv()),
      shown_u(model.nv()),
      change(model.nv()) {
  detail::neutral(model, now.q.data());
  now.v.setZero();
  looked_q.fill(now.q);
  looked_v.fill(now.v);
  if (o.limits) contacts().watchLimits();
  if (!rubs()) return;
  for (std::vector<char>* marks : {&resting, &halted, &stopped, &turned}) marks->resize(contacts().rubbing().size());
}

void Simulator::Impl::requireIdle(const char* function) const {
  if (working)
    throw Error(ErrorCode::argument,
                std::string(function) + ": it is called by a callback of this very simulation; do it when advance() has returned");
}

Unilateral& Simulator::Impl::contacts() {
  if (!unilateral) unilateral.emplace(equations.model(), constraints ? &*constraints : nullptr);
  return *unilateral;
}

void Simulator::Impl::checkFinite(const Moment& x, double h) const {
  if (x.q.allFinite() && x.v.allFinite()) return;
  const std::string after = h > 0 ? " after a step of " + number(h) + " s" : "";
  for (const JointRecord& joint : equations.model().joints()) {
    const auto look = [&](const char* what, const Eigen::VectorXd& values, int first, int count) {
      for (int k = first; k < first + count; ++k)
        if (!std::isfinite(values[k]))
          throw Error(ErrorCode::simulation, "at t = " + number(x.time) + " s its " + what + " is " + number(values[k]) + after, {{}, 0, joint.name});
    };
    look("configuration", x.q, joint.idx_q, joint.nq);
    look("velocity", x.v, joint.idx_v, joint.nv);
  }
}

StepOutcome Simulator::Impl::stepOrPass(double h) {
  StepOutcome outcome = stepper->step(h, now, next);
  if (outcome == StepOutcome::taken || !equations.constrained()) return outcome;
  struct Kept {
    ConstraintSettings& settings;
    ConstraintSettings own = settings;
    ~Kept() { settings = own; }
  } kept{equations.constraints().settings};
  for (const double wider : {1e-6, 1e-4, 1e-2}) {
    kept.settings.rank_tolerance = wider;
    outcome = stepper->step(h, now, next);
    if (outcome == StepOutcome::taken) break;
  }
  return outcome;
}

bool Simulator::Impl::attempt(double h, double until, std::string& why) {
  next.time = until;
  equations.fault.clear();
  try {
    holdJoints(h);
    const StepOutcome outcome = stepOrPass(h);
    if (outcome == StepOutcome::taken && equations.fault.empty()) {
      settleJoints();
      return true;
    }
    why = !equations.fault.empty()             ? equations.fault
          : outcome == StepOutcome::not_finite ? "what it leads to is not finite"
                                               : "it has equations that iterations do not solve; take shorter ones";
  } catch (const Error& e) {
    // A failure of a callback is no failure of the step, so it is passed on.
    if (e.code() == ErrorCode::simulation) throw;
    why = e.what();
  }
  return false;
}

void Simulator::Impl::stepBy(double h, double until) {
  std::string why;
  if (!attempt(h, until, why))
    throw Error(ErrorCode::simulation, "the step of " + number(h) + " s from t = " + number(now.time) + " s cannot be taken: " + why);
  checkFinite(next, h);
}

void Simulator::Impl::countStep(double h) {
  counted_time += h;
  if (++counted_steps < many_steps) return;
  const double led = counted_time;
  counted_steps = 0;
  counted_time = 0;
  if (led >= least_share * many_steps * options.dt) return;
  const std::vector<JointRecord>& joints = equations.model().joints();
  std::size_t worst = 1;
  while (worst + 1 < joints.size() && joints[worst + 1].idx_v <= stepper->worst()) ++worst;
  throw Error(
      ErrorCode::simulation,
      "at t = " + number(now.time) + " s the last " + std::to_string(many_steps) + " steps have led " + number(led) +
          " s further: this joint's motion is stiff (much damping, or little inertia?); use an implicit integrator as radau5, or a shorter dt",
      {{}, 0, joints[worst].name});
}

double Simulator::Impl::adaptiveStep(double most) {
  bool rejected = false, taken = true, finite = true;
  std::string why;
  for (;;) {
    const bool shortened = trial + slack * options.dt >= most;
    const double h = shortened ? most : trial;
    if (!shortened && (h < 0x1p-40 * options.dt || now.time + h == now.time))
      throw Error(ErrorCode::simulation, "at t = " + number(now.time) + " s steps have collapsed to " + number(h) + " s: " +
                                             (!taken    ? why
                                              : !finite ? "what they lead to is not finite"
                                                        : "none keeps the tolerance of " + number(options.tolerance)));
    taken = attempt(h, now.time + h, why);
    const double error = stepper->error();
    finite = taken && std::isfinite(error) && next.q.allFinite() && next.v.allFinite();
    const double factor = finite ? std::clamp(0.9 * std::pow(error, -0.2), 0.2, rejected ? 1.0 : 5.0) : 0.2;
    if (finite && error <= 1) {
      // A step that was cut short changes the trial step only if its error asks for a shorter one.
      if (!shortened || factor < 1) trial = h * factor;
      if (!shortened) countStep(h);
      return h;
    }
    trial = h * factor;
    rejected = true;
    ++equations.statistics.rejected;
  }
}

void Simulator::Impl::project() {
  if (!options.project || !equations.constrained()) return;
  if (!equations.project(next.q.data(), next.v.data()))
    throw Error(ErrorCode::simulation,
                "after the step to t = " + number(next.time) + " s no configuration near keeps the constraints: take shorter ones");
  // Joints at rest get a velocity of exactly zero, whatever rounding errors the projection has made.
  for (std::size_t k = 0; k < stopped.size(); ++k)
    if (stopped[k]) next.v[unilateral->rubbing()[k].dof] = 0;
  next.has_acceleration = false;
}

double Simulator::Impl::stepTowards(double until) {
  double h = 0;
  untold.clear();
  contact_step = has_impact = false;
  cut = 0;
  std::fill(halted.begin(), halted.end(), 0);
  if (infoOf(options.integrator).adaptive) {
    h = adaptiveStep(longestStep(until - now.time));
    // The last step ends exactly at the requested time, however the sum is rounded.
    next.time = h == until - now.time ? until : now.time + h;
  } else {
    // Times of whole steps are multiples of dt, so that rounding errors do not add up.
    const double whole = anchor + static_cast<double>(steps + 1) * options.dt;
    if (whole == now.time)
      throw Error(ErrorCode::simulation, "at t = " + number(now.time) + " s a step of dt = " + number(options.dt) +
                                             " s is less than what tells two times apart; take a longer one");
    const bool fits = whole <= until + slack * options.dt;
    h = fits ? options.dt : until - now.time;
    stepBy(h, !fits || std::abs(whole - until) <= slack * options.dt ? until : whole);
    whole_step = fits;
  }
  project();
  if (hasStrayed(h)) h = followBranch(h);
  return unilateral && unilateral->watches() ? touch(h) : comeToRest(h);
}

void Simulator::Impl::retake(double h) {
  if (contact_step) {
    contact_u *= h / (next.time - now.time);
    glide(1, next.q.data(), next.v.data());
    next.time = now.time + h;
  } else {
    stepBy(h, now.time + h);
    if (h == cut) stopTurned();
  }
  project();
  has_impact = false;
}

void Simulator::Impl::commit() {
  std::swap(now, next);
  now_closed = options.project && equations.constrained();
  if (has_impact) {
    now.v = after_impact;
    now.has_acceleration = false;
  }
  ++equations.statistics.steps;
  if (whole_step) {
    ++steps;
  } else {
    anchor = now.time;
    steps = 0;
  }
}

Simulator::Simulator(const CompactModel& model, const SimulatorOptions& options) : Simulator(ConstraintSet(model), options) {}
Simulator::Simulator(const ConstraintSet& constraints, const SimulatorOptions& options)
    : impl_(std::make_unique<Impl>(constraints.model(), constraints.count() > 0 ? &constraints : nullptr, options)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

const CompactModel& Simulator::model() const { return impl_->equations.model(); }
const SimulatorOptions& Simulator::options() const { return impl_->options; }
double Simulator::time() const { return impl_->now.time; }
VectorResult Simulator::q() const { return {impl_->now.q.data(), impl_->now.q.size()}; }
VectorResult Simulator::v() const { return {impl_->now.v.data(), impl_->now.v.size()}; }
const SimulatorStatistics& Simulator::statistics() const { return impl_->equations.statistics; }
bool Simulator::touches() const { return impl_->contact_step; }
double Simulator::energy() { return impl_->equations.energy(impl_->now.q.data(), impl_->now.v.data()); }
double Simulator::constraintError() { return impl_->equations.constraintError(impl_->now.q.data(), impl_->now.v.data()); }
VectorResult Simulator::acceleration() {
  const Work work(*impl_, "Simulator::acceleration");
  Moment& x = impl_->now;
  std::fill(impl_->halted.begin(), impl_->halted.end(), 0);
  impl_->holdJoints(impl_->options.dt);
  return {impl_->equations.acceleration(x.time, x.q.data(), x.v.data()), x.v.size()};
}

void Simulator::setController(Controller controller, ControllerDerivatives derivatives) {
  impl_->requireIdle("Simulator::setController");
  impl_->equations.controller = std::move(controller);
  impl_->equations.controller_derivatives = std::move(derivatives);
  impl_->now.has_acceleration = false;
}

void Simulator::setForces(Forces forces) {
  impl_->requireIdle("Simulator::setForces");
  impl_->equations.forces = std::move(forces);
  impl_->now.has_acceleration = false;
}

void Simulator::setContacts(ContactFinder finder) {
  impl_->requireIdle("Simulator::setContacts");
  impl_->contacts().setFinder(std::move(finder));
}

void Simulator::resetTo(VectorView q, VectorView v, double time) {
  const Work work(*impl_, "Simulator::reset");
  const CompactModel& m = model();
  checkSize("Simulator::reset", "q", q, m.nq());
  checkSize("Simulator::reset", "v", v, m.nv());
  if (!std::isfinite(time)) refuse("the time is " + number(time));
  Moment x(m);
  x.time = time;
  x.q = VectorResult(q.data, q.size);
  x.v = VectorResult(v.data, v.size);
  impl_->checkFinite(x, 0);
  impl_->start(std::move(x));
}

void Simulator::Impl::checkSteps(double until) const {
  if (infoOf(options.integrator).adaptive || !((until - now.time) / options.dt > most_steps)) return;
  throw Error(ErrorCode::argument, "Simulator::advance: from t = " + number(now.time) + " s to " + number(until) + " s there are " +
                                       number((until - now.time) / options.dt) + " steps of " + number(options.dt) + " s: that would never end");
}

void Simulator::Impl::start(Moment from) {
  checkConfiguration("q", equations.model().impl(), from.q.data());
  std::vector<int> sides(events.size());
  readEvents(from, sides);
  now = std::move(from);
  signs = std::move(sides);
  now_closed = false;
  untold.clear();
  touching.clear();
  contact_step = false;
  anchor = now.time;
  steps = 0;
  trial = options.dt;
  counted_steps = 0;
  counted_time = 0;
  equations.statistics = {};
}

void Simulator::step() {
  Impl& x = *impl_;
  const Work work(x, "Simulator::step");
  if (infoOf(x.options.integrator).adaptive) {
    x.stepTowards(std::numeric_limits<double>::infinity());
  } else {
    x.stepTowards(x.anchor + static_cast<double>(x.steps + 1) * x.options.dt);
  }
  x.commit();
  x.readEvents(x.now, x.signs);
}

}  // namespace dyn
