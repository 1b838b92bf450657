// SPDX-License-Identifier: BSD-2-Clause
// dyn simulate: a robot's motion through time, the change of its conserved quantities, and the speed of the computation.
#include "commands.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "motion_options.hpp"
#include "options.hpp"
#include "progress.hpp"
#include "trajectory.hpp"

#include <dyn/file.hpp>

#include <report/svg.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>

namespace dyn::tool {

namespace {

constexpr std::size_t most_numbers = 1u << 28;  ///< in a trajectory kept in memory: 2 GiB

struct SimulateOptions : MotionOptions {
  std::string state, named, out, plot, save, resume;
  double every = 0;

  void add(CLI::App& app) {
    MotionOptions::add(app);
    app.add_option("--state", state, "JSON file whose first sample is where to start; without it and --q at neutral and at rest")
        ->type_name("FILE")
        ->check(fileName());
    addNamedState(app, named, "--state");
    app.add_option("--every", every, "seconds between the states of --out and --plot; without it a thousand of them, but no more than steps")
        ->check(notNegative());
    app.add_option("--out", out, "trajectory, .csv or .json")->type_name("FILE")->check(fileName({".csv", ".json"}, "trajectories"));
    app.add_option("--plot", plot, "picture of the configuration over time, SVG")->type_name("FILE")->check(fileName({".svg"}, "pictures"));
    app.add_option("--save", save, "write where the simulation ended, without loss")->type_name("FILE")->check(fileName());
    app.add_option("--resume", resume, "go on from there")->type_name("FILE")->check(fileName())->excludes("--state")->excludes("--q");
  }

  /// Times of the states to keep, including the first and the last. Throws Error(argument) if these need more than 2 GiB.
  std::vector<double> times(double from, std::size_t numbers_a_state) const {
    const double step = every > 0 ? every : std::max(dt, time / 1000), count = std::ceil(time / step - 1e-9);
    if (count * static_cast<double>(numbers_a_state) > static_cast<double>(most_numbers))
      throw Error(ErrorCode::argument, "with a state every " + benchmark::shortNumber(step) + " s they take more than 2 GiB; give a larger --every");
    std::vector<double> all;
    for (long k = 0; k < static_cast<long>(count); ++k) all.push_back(from + static_cast<double>(k) * step);
    all.push_back(from + time);
    return all;
  }
};

/// Whether the model is one tree on a free joint. Its momentum then changes by gravity alone, if nothing else acts.
bool floats(const CompactModel& model) {
  int roots = 0;
  bool free = false;
  for (std::size_t k = 1; k < model.joints().size(); ++k) {
    const JointRecord& joint = model.joints()[k];
    if (joint.parent != 0) continue;
    ++roots;
    free = joint.type == "free_flyer";
  }
  return roots == 1 && free;
}

struct Momentum {
  Eigen::VectorXd value;
  Momentum(const CompactModel& model, Data& data, const Simulator& s) : value(ccrba(model, data, s.q(), s.v()).hg) {}
};

void start(const SimulateOptions& o, const Model& description, Simulator& simulator, const ConstraintSet& constraints) {
  const CompactModel& model = simulator.model();
  if (!o.resume.empty()) return simulator.resume(readFile(o.resume));
  Eigen::VectorXd q = neutral(model), v = Eigen::VectorXd::Zero(model.nv());
  if (!o.state.empty()) {
    const std::vector<State> states = timed("read states from " + o.state, [&] { return readStates(o.state, model); });
    if (states.empty()) throw Error(ErrorCode::syntax, "has no sample to start from", {o.state, 0, ""});
    q = states.front().q;
    v = states.front().v;
  }
  if (!o.named.empty()) {
    q = namedConfiguration(model, description, o.named);
    v = namedVelocity(model, description, o.named);
  }
  assembleState(model, constraints, q, v);
  simulator.reset(q, v);
}

void run(const SimulateOptions& o) {
  for (const std::string& path : {o.out, o.plot, o.save})
    if (!path.empty()) checkReplaceable(path);
  const Model description = o.volumes.description(o);
  const CompactModel model = o.compile(description);
  const ConstraintSet constraints = o.constraints(model);
  Simulator simulator(constraints, o.simulator());
  const ContactFinder finder = o.finder(model, description);
  if (finder) simulator.setContacts(finder);
  start(o, description, simulator, constraints);
  const double from = simulator.time(), until = from + o.time;
  const std::vector<double> times = o.times(from, static_cast<std::size_t>(model.nq() + model.nv()) + 2);

  Data data(model, Need::derivatives);
  const bool floating = floats(model) && constraints.rows() == 0 && !finder;
  std::optional<Momentum> before;
  if (floating) before.emplace(model, data, simulator);
  Trajectory trajectory(model);
  const auto energyOf = [&](const auto& q, const auto& v) {
    const double energy = computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q);
    if (!std::isfinite(energy))
      throw Error(ErrorCode::simulation, "the energy is not finite: numbers of the model or of the state are beyond their range");
    return energy;
  };
  energyOf(simulator.q(), simulator.v());
  const auto clock = [] { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); };
  double watched = 0;
  const double started = clock();
  std::optional<Error> failure;
  const Interruption interruption;
  {
    Progress progress(o.time, "s");
    try {
      simulator.advance(until, times, [&](double t, const VectorResult& q, const VectorResult& v) {
        if (interruption) throw Error(ErrorCode::simulation, "interrupted");  // the states so far are kept
        const double since = clock();
        trajectory.add(t, q, v, energyOf(q, v));
        progress.at(t - from);
        watched += clock() - since;
      });
    } catch (const Error& e) {
      failure = e;
    }
  }
  const double seconds = std::max(clock() - started - watched, 1e-9);

  const SimulatorStatistics& s = simulator.statistics();
  std::printf("%s: %d degrees of freedom, %s, %s %g\n", model.name().c_str(), model.nv(), o.integrator.c_str(),
              infoOf(simulator.options().integrator).adaptive ? "tolerance" : "dt",
              infoOf(simulator.options().integrator).adaptive ? o.tolerance : o.dt);
  std::printf("%ld steps (%ld rejected) to t = %.9g s in %.3g s: %.3g steps/s, %ld evaluations\n", s.steps, s.rejected, simulator.time(), seconds,
              static_cast<double>(s.steps) / seconds, s.evaluations);
  if (!trajectory.empty())
    std::printf("energy: %.9g J at first, %.9g J at last, largest change %.3g J\n", trajectory.firstEnergy(), trajectory.lastEnergy(),
                trajectory.energyDrift());
  if (floating) {
    Eigen::VectorXd change = Momentum(model, data, simulator).value - before->value;
    const Vec3<double>& g = model.gravity();
    const double impulse = model.mass() * (simulator.time() - from);
    change.head<3>() -= impulse * Eigen::Vector3d(g.x, g.y, g.z);
    std::printf("momentum: linear changed by %.3g N s beyond gravity's, angular about the centre of mass by %.3g N m s\n", change.head<3>().norm(),
                change.tail<3>().norm());
  }
  if (s.impacts + s.contact_steps > 0)
    std::printf("contact: %ld touched, %ld impacts with a rebound, %ld steps in touch\n", s.touched, s.impacts, s.contact_steps);
  if (s.inexact_contacts > 0) std::printf("of these %ld with forces that are not right to 1e-9 m/s\n", s.inexact_contacts);
  if (constraints.rows() > 0) std::printf("constraints: %d rows, error %.3g\n", constraints.rows(), simulator.constraintError());
  if (!o.save.empty()) timed("wrote " + o.save, [&] { replaceFile(o.save, simulator.save()); });
  if (!o.out.empty()) timed("wrote " + o.out, [&] { trajectory.write(o.out); });
  if (!o.plot.empty()) timed("wrote " + o.plot, [&] { trajectory.plot(o.plot); });
  interruption.end();
  if (failure) throw *failure;
}

}  // namespace

void addSimulate(CLI::App& app) {
  CLI::App* sub = addCommand(app, "simulate", "moves a model through time; energy, momentum and constraint drift, trajectory and picture");
  auto o = std::make_shared<SimulateOptions>();
  o->add(*sub);
  sub->callback([o] { run(*o); });
}

}  // namespace dyn::tool
