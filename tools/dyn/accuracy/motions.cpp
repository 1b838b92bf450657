// SPDX-License-Identifier: BSD-2-Clause
#include "interrupt.hpp"
#include "oracle.hpp"
#include "problems.hpp"
#include "progress.hpp"
#include "sections.hpp"

#include <dyn/dyn.hpp>

#include <report/quartiles.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <optional>

namespace dyn::tool {

namespace {

struct MotionProblem {
  std::string name, about;
  CompactModel model;
  State start;
  double time;
  State end;               ///< from the reference
  double uncertainty = 0;  ///< change of `end` by the last refinement of the reference [rad, m]
};

struct Point {
  double h = 0;        ///< step, or tolerance of an adaptive method
  double seconds = 0;  ///< median of three
  double error = 0;    ///< largest difference from the reference's configuration [rad, m]
  double drift = 0;    ///< largest change of energy, at the ends of 64 parts of the motion [J]
  long evaluations = 0, factorizations = 0;
};

/// Computes problem.end by the reference. Its steps are halved until the end changes by less than 1e-13, or up to 1600 steps.
void follow(const Oracle& oracle, MotionProblem& problem) {
  constexpr int most_steps = 1600;
  State before = oracle.move(problem.start, problem.time, 25);
  for (int steps = 50;; steps *= 2) {
    problem.end = oracle.move(problem.start, problem.time, steps);
    problem.uncertainty = (problem.end.q - before.q).cwiseAbs().maxCoeff();
    if (problem.uncertainty < 1e-13 || steps >= most_steps) return;
    before = problem.end;
  }
}

/// Empty if the simulation fails with such steps.
std::optional<Point> measureMotion(const MotionProblem& problem, const SimulatorOptions& options, bool adaptive) {
  Point point;
  point.h = adaptive ? options.tolerance : options.dt;
  std::vector<double> times;
  constexpr int repetitions = 3, parts = 64;
  try {
    for (int repetition = 0; repetition < repetitions; ++repetition) {
      Simulator s(problem.model, options);
      s.reset(problem.start.q, problem.start.v);
      const auto begin = std::chrono::steady_clock::now();
      s.advance(problem.time);
      times.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      point.error = difference(problem.model, problem.end.q, s.q()).cwiseAbs().maxCoeff();
      point.evaluations = s.statistics().evaluations;
      point.factorizations = s.statistics().factorizations;
    }
    Simulator s(problem.model, options);
    s.reset(problem.start.q, problem.start.v);
    const double before = s.energy();
    // Energy is read at the ends of steps. Between them its error would be that of the interpolating polynomial.
    for (int k = 1; k <= parts; ++k) {
      while (s.time() < problem.time * k / parts) s.step();
      point.drift = std::max(point.drift, std::abs(s.energy() - before));
    }
  } catch (const Error& e) {
    if (e.code() != ErrorCode::simulation) throw;
    return {};
  }
  point.seconds = benchmark::quartiles(times).median;
  if (!std::isfinite(point.error) || !std::isfinite(point.drift)) return {};
  return point;
}

MotionProblem falling(const Specimen& x) {
  const CompactModel& model = x.model;
  State start;
  // The start differs from the neutral posture, so that all joints move.
  start.q = integrate(model, neutral(model), Eigen::VectorXd::Constant(model.nv(), 0.3));
  start.v = Eigen::VectorXd::Constant(model.nv(), 0.2);
  MotionProblem problem{model.name() + " falling", "from a bent posture, without torques or losses", model, start, 0.5, {}};
  follow(Oracle(x.description, model), problem);
  return problem;
}

std::vector<MotionProblem> problemsOf(const std::vector<Specimen>& specimens, const JointRegistry& registry, bool quick) {
  std::vector<MotionProblem> out;
  const double part = quick ? 0.2 : 1;  // of each motion's time
  const auto add = [&](const std::string& name, const std::string& about, const Model& description, const State& start, double time) {
    const CompactModel model = compile(description, registry);
    out.push_back({name, about, model, start, part * time, {}});
    follow(Oracle(description, model), out.back());
  };
  const auto vector = [](std::initializer_list<double> x) {
    return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd>(x.begin(), static_cast<Eigen::Index>(x.size())));
  };
  State start;
  start.q = vector({0.5, 0.25});
  start.v = vector({0, 0});
  add("double pendulum", "regular: disturbances grow 3.5 times in ten seconds", pendulum(2), start, 10);
  start.q = vector({0.28, 0, 0, 0.96});
  start.v = vector({0, 0, 30});
  add("spinning top", "heavy, 30 rad/s", heavyTop(), start, 1);
  start.q = vector({0, 0, 0, 1});
  start.v = vector({0x1p-7, 1, 0x1p-6});
  add("free body", "turns over about its intermediate axis", freeBody(), start, 10);
  {
    // All cranks turn as one crank with their inertia does. So the loop's motion is known from a model without a loop.
    const Model description = fourBars(1), crank = fourBarsCrank(1);
    const CompactModel model = compile(description, registry), single = compile(crank, registry);
    MotionProblem one{"", "", single, {}, part * 10, {}};
    one.start.q = vector({0});
    one.start.v = vector({-1});
    follow(Oracle(crank, single), one);
    MotionProblem loop{"four-bar", "a closed loop, through positions where its bars are in line", model, {}, one.time, {}, one.uncertainty};
    loop.start.q = loop.end.q = neutral(model);
    loop.start.v = Eigen::VectorXd::Zero(model.nv());
    for (const JointRecord& joint : model.joints()) {
      if (joint.nv == 0) continue;
      const double sign = joint.name[1] == 'r' ? 1 : -1;  // couplers turn opposite to the cranks
      loop.start.v[joint.idx_v] = sign * one.start.v[0];
      loop.end.q[joint.idx_q] = sign * one.end.q[0];
    }
    out.push_back(std::move(loop));
  }
  for (const Specimen& x : specimens)
    if (!quick && !Interruption::pending() && !x.path.empty() && x.model.nv() <= 20) out.push_back(falling(x));
  return out;
}

}  // namespace

Section motionSection(const std::vector<Specimen>& specimens, const AccuracyOptions& options) {
  Section out;
  out.id = "motions";
  out.title = "Integrators: time against error";
  out.text = {
      "For each method, steps are halved (tolerances divided by ten) until rounding shows; to the left and down is better. The first picture of a "
      "problem is against the error of the final configuration, the second against the largest change of energy: a method can look perfect in energy "
      "and be late. References are by extrapolation of order 16 on fifty-digit accelerations. Dashed lines have the slopes of orders 1, 2 and 4.",
      "What limits each curve: its order, until rounding times the growth of disturbances stops it; of the closed loop the projection onto it, at "
      "about 1e-13. Where a method has no point its steps were unstable or its equations had no solution."};
  out.table.columns = {"problem",          "integrator",  "step or tolerance", "seconds",          "error",
                       "energy drift [J]", "evaluations", "factorizations",    "reference good to"};
  const JointRegistry registry = JointRegistry::standard();
  for (const MotionProblem& problem : problemsOf(specimens, registry, options.quick)) {
    if (Interruption::pending()) break;
    const auto label = [&](const char* what) { return benchmark::LineChart::Label{what, benchmark::Scale::logarithmic}; };
    benchmark::LineChart by_error(problem.name + ": " + problem.about, label("error of the final configuration [rad, m]"), label("seconds"));
    benchmark::LineChart by_drift(problem.name + ": energy", label("largest change of energy [J]"), label("seconds"));
    std::optional<Point> anchor;
    const int finest = options.quick ? 4 : 8;
    Progress progress(static_cast<double>(integrators().size()) * (finest + 1), "motions");
    double done = 0;
    for (const IntegratorInfo& info : integrators()) {
      for (int k = 0; k <= finest; ++k) {
        if (Interruption::pending()) break;
        progress.at(done++, problem.name + ": " + info.name);
        const SimulatorOptions simulation{
            .integrator = info.integrator, .dt = problem.time * std::ldexp(0.01, -k), .tolerance = std::pow(10.0, -3 - 1.25 * k)};
        const std::optional<Point> point = measureMotion(problem, simulation, info.adaptive);
        if (!point) continue;
        if (!anchor && info.integrator == Integrator::rk4) anchor = point;
        by_error.add(info.name, std::max(point->error, 1e-17), point->seconds);
        by_drift.add(info.name, std::max(point->drift, 1e-17), point->seconds);
        out.table.rows.push_back({problem.name, info.name, point->h, point->seconds, point->error, point->drift, point->evaluations,
                                  point->factorizations, problem.uncertainty});
      }
    }
    if (anchor)
      for (const int order : {1, 2, 4}) by_error.guide("order " + std::to_string(order), anchor->error, anchor->seconds, -1.0 / order);
    out.charts.push_back(std::move(by_error));
    out.charts.push_back(std::move(by_drift));
  }
  return out;
}

Section driftSection(const AccuracyOptions& options) {
  Section out;
  out.id = "drift";
  out.title = "Energy over a long time";
  out.text = {
      "The double pendulum with steps of 1/128 s: largest change of energy so far, of 24 J. Symmetric and variational methods stay where they are "
      "after "
      "the first swing; Runge-Kutta's drifts with the time; semi-implicit Euler is not symplectic in (q, v) where the inertia depends on q, and its "
      "energy leaves as the square root of the number of steps or faster."};
  out.table.columns = {"integrator", "steps", "largest change of energy [J]"};
  benchmark::LineChart chart("Double pendulum, dt = 1/128 s", {"steps", benchmark::Scale::logarithmic},
                             {"largest change of energy [J]", benchmark::Scale::logarithmic});
  const CompactModel model = compile(pendulum(2), JointRegistry::standard());
  for (const IntegratorInfo& info : integrators()) {
    if (info.adaptive || info.integrator == Integrator::explicit_euler) continue;
    Simulator s(model, {.integrator = info.integrator, .dt = 0x1p-7});
    s.reset((Eigen::VectorXd(2) << 0.5, 0.25).finished(), Eigen::VectorXd::Zero(2));
    const double before = s.energy();
    double drift = 0;
    const long most = options.quick ? 20000 : 1000000;
    Progress progress(static_cast<double>(most), "steps");
    long next = 10;
    for (long k = 1; k <= most && !Interruption::pending(); ++k) {
      progress.at(static_cast<double>(k), std::string("energy with ") + info.name);
      s.step();
      drift = std::max(drift, std::abs(s.energy() - before));
      if (k != next) continue;
      chart.add(info.name, static_cast<double>(k), drift);
      out.table.rows.push_back({info.name, k, drift});
      next = next * 3 / 2;
    }
  }
  out.charts.push_back(std::move(chart));
  return out;
}

}  // namespace dyn::tool
