// SPDX-License-Identifier: BSD-2-Clause
// Difficult motions compared with accurate references. Each bound follows from the method's order or from the inevitable rounding error (number of
// steps times u, times the growth of a disturbance of the start).
#include "integrate/problems.hpp"
#include "oracle.hpp"

#include <dyn/parsers/urdf.hpp>

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

namespace {

constexpr double u = 0x1p-53;

/// Largest absolute changes of the energy since the start, taken at every step.
struct Drift {
  double most = 0, early = 0, late = 0;  ///< over the whole time, its first and its last tenth

  Drift(Simulator& s, long steps) {
    const double before = s.energy();
    for (long k = 0; k < steps; ++k) {
      s.step();
      const double e = std::abs(s.energy() - before);
      most = std::max(most, e);
      if (k < steps / 10) early = std::max(early, e);
      if (k >= steps - steps / 10) late = std::max(late, e);
    }
  }
};

}  // namespace

TEST_CASE("the free body's attitude is kept through its flips, to the growth of rounding", "[motion]") {
  DYN_NEEDS_SHARED();
  const CompactModel model = compile(tool::freeBody(), registry());
  const std::vector<State> reference = rigidReference("torque_free");
  // The body passes the unstable axis every 17.5 s, which multiplies disturbances. After 100 s even a method without own error is off by 3e-11
  // (hardcases.md, 4.3).
  for (std::size_t k = 1; k < reference.size(); ++k) {
    const double bound = reference[k].time > 10 ? 1e-10 : 1e-12;
    CHECK(errorAt(model, {.integrator = Integrator::gauss6, .dt = 0x1p-6}, reference[0], reference[k]) < bound);
    CHECK(errorAt(model, {.integrator = Integrator::rk4, .dt = 1e-3}, reference[0], reference[k]) < bound);
    CHECK(errorAt(model, {.integrator = Integrator::dormand_prince, .dt = 0.1, .tolerance = 1e-13}, reference[0], reference[k]) < bound);
  }
}

TEST_CASE("implicit midpoint keeps the free body's energy and the size of its momentum", "[motion]") {
  const CompactModel model = compile(tool::freeBody(), registry());
  Simulator s(model, {.integrator = Integrator::implicit_midpoint, .dt = 1e-2});
  const Vector v = (Vector(3) << 0x1p-7, 1, 0x1p-6).finished(), moments = (Vector(3) << 1, 2, 3).finished();
  s.reset(neutral(model), v);
  const double E = s.energy(), L = moments.cwiseProduct(v).norm();
  const long steps = 100000;
  double dE = 0, dL = 0;
  for (long k = 0; k < steps; ++k) {
    s.step();
    dE = std::max(dE, std::abs(s.energy() - E) / E);
    dL = std::max(dL, std::abs(moments.cwiseProduct(s.v()).norm() - L) / L);
  }
  // Energy and squared momentum are quadratic in v, and Gauss methods keep quadratic invariants. So one rounding a step remains.
  CHECK(dE < static_cast<double>(steps) * u);
  CHECK(dL < static_cast<double>(steps) * u);
}

TEST_CASE("the heavy top nutates, precesses and spins as the elliptic functions say", "[motion]") {
  DYN_NEEDS_SHARED();
  const CompactModel model = compile(tool::heavyTop(), registry());
  const std::vector<State> reference = rigidReference("heavy_top");
  for (std::size_t k = 1; k < reference.size(); ++k) {
    // The spin alone is 30 t rad. Each step rounds this angle, so the error is 30 t u times the number of steps.
    const double t = reference[k].time, dt = 0x1p-9, bound = 30 * t * u * t / dt;
    INFO("at " << t << " s");
    CHECK(errorAt(model, {.integrator = Integrator::gauss6, .dt = dt}, reference[0], reference[k]) < bound);
    CHECK(errorAt(model, {.integrator = Integrator::dormand_prince, .tolerance = 1e-13}, reference[0], reference[k]) < 1e-11 * (1 + 30 * t));
  }
}

TEST_CASE("the simple pendulum is where it should be after ten seconds", "[motion]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json truth = truthFile("data/ref_pendula.json")["A01"];
  const CompactModel model = compile(tool::pendulum(1), registry());
  const double dt = 0x1p-8;
  Simulator s(model, {.integrator = Integrator::gauss6, .dt = dt});
  s.reset(Vector::Constant(1, M_PI / 2), Vector::Zero(1));
  s.advance(10);
  // The pendulum rotates about y and hangs down at q = 0, so the mass is at (-sin q, -cos q). It started at x = -1. The bound is one rounding a step
  // at speeds up to 4.4 rad/s.
  const double bound = 4.4 * u * 10 / dt;
  CHECK(std::abs(-std::sin(s.q()[0]) - number(truth["x"])) < bound);
  CHECK(std::abs(-std::cos(s.q()[0]) - number(truth["y"])) < bound);
}

TEST_CASE("the double pendulum is followed to rounding where it is regular, to growth times rounding where it is chaotic", "[motion]") {
  DYN_NEEDS_SHARED();
  const bool chaotic = GENERATE(false, true);
  const CompactModel model = compile(tool::pendulum(2), registry());
  const std::vector<State> reference = pendulumReference(chaotic);
  const std::vector<double> growth = chaotic ? std::vector<double>{15, 1.1e9} : std::vector<double>{1.9, 3.5, 5.5};
  for (std::size_t k = 0; k < growth.size(); ++k) {
    const State& end = reference[k + 1];
    const double dt = 0x1p-8, bound = growth[k] * u * end.time / dt;
    INFO("at " << end.time << " s, chaotic " << chaotic);
    CHECK(errorAt(model, {.integrator = Integrator::gauss6, .dt = dt}, reference[0], end) < bound);
    // This method chooses its own steps. Each adds a rounding error and an error within the tolerance.
    CHECK(errorAt(model, {.integrator = Integrator::dormand_prince, .tolerance = 1e-14}, reference[0], end) < 100 * bound);
  }
}

TEST_CASE("over a million steps the energy of symmetric and variational methods does not drift", "[motion][long]") {
  const CompactModel model = compile(tool::pendulum(2), registry());
  const Integrator integrator = GENERATE(Integrator::implicit_midpoint, Integrator::variational);
  const double dt = 0x1p-7;
  Simulator s(model, {.integrator = integrator, .dt = dt});
  const Vector q = (Vector(2) << 0.5, 0.25).finished(), v = Vector::Zero(2);
  s.reset(q, v);
  const double E = std::abs(s.energy());
  const Drift drift(s, 1000000);
  INFO(infoOf(integrator).name << ": most " << drift.most << ", first tenth " << drift.early << ", last tenth " << drift.late);
  // The energy error is bounded by a multiple of dt^2 with the frequency of the faster mode, w^2 = (2 + sqrt 2) g = 33.
  CHECK(drift.most < 33 * dt * dt * E);
  CHECK(drift.most > 1e-3 * dt * dt * E);
  // There is no trend: the last tenth is no worse than the first.
  CHECK(drift.late < 1.01 * drift.early);
}

TEST_CASE("semi-implicit Euler drifts where the inertia depends on the configuration, as is said of it", "[motion][long]") {
  const CompactModel model = compile(tool::pendulum(2), registry());
  Simulator s(model, {.integrator = Integrator::semi_implicit_euler, .dt = 1e-2});
  s.reset((Vector(2) << 0.5, 0.25).finished(), Vector::Zero(2));
  const Drift drift(s, 100000);
  CHECK(drift.most > 20);  // it gains 43 J, more than the 24 J that it had (hardcases.md, 4.3)
}

TEST_CASE("free fall: Euler's methods lose or win m g^2 h t / 2, all others nothing", "[motion]") {
  const CompactModel model = compile(tool::body("free_flyer", 2.5, {0.1, 0, -0.2}, {0.1, 0.2, 0.25}, 9.81), registry());
  const double g = 9.81, m = 2.5, h = 0x1p-7, t = 2;
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(model, {.integrator = info.integrator, .dt = h});
    const double before = s.energy();
    s.advance(t);
    const double law = info.integrator == Integrator::explicit_euler ? 0.5 : info.integrator == Integrator::semi_implicit_euler ? -0.5 : 0.0;
    INFO(info.name);
    const double energies = m * g * g * t * t;  // kinetic and potential energy, which cancel
    CHECK(std::abs(s.energy() - before - law * m * g * g * h * t) < energies * u * t / h);
  }
}

TEST_CASE("symmetric methods come back to where they started when time is turned", "[motion]") {
  const CompactModel model = compile(tool::pendulum(2), registry());
  const Integrator integrator = GENERATE(Integrator::implicit_midpoint, Integrator::gauss6, Integrator::variational);
  const double dt = 0x1p-7, t = 10;
  Simulator s(model, {.integrator = integrator, .dt = dt});
  const Vector q = (Vector(2) << 0.5, 0.25).finished();
  s.reset(q, Vector::Zero(2));
  s.advance(t);
  CHECK(largest(s.q() - q) > 0.1);
  s.reset(Vector(s.q()), Vector(-s.v()));
  s.advance(t);
  // Disturbances grow by 3.5 in ten seconds. The implicit equations are solved mostly to rounding, at worst to 2^-40 of the velocities.
  CHECK(largest(s.q() - q) < 3.5 * 3.5 * 2 * t / dt * u * 10);
}

TEST_CASE("a rotation of ten million steps stays a rotation, and the right one", "[motion][long]") {
  const CompactModel model = compile(tool::body("spherical", 1, {}, {1, 1, 1}, 0), registry());
  Simulator s(model, {.integrator = Integrator::semi_implicit_euler, .dt = 1e-3});
  const Vector w = (Vector(3) << 0.3, -0.4, 0.5).finished();
  s.reset(neutral(model), w);
  const long steps = 10000000;
  for (long k = 0; k < steps; ++k) s.step();
  // The exact angle, reduced by whole turns with more digits than a double has.
  const long double angle =
      std::sqrt(static_cast<long double>(0.3) * 0.3 + static_cast<long double>(0.4) * 0.4 + static_cast<long double>(0.5) * 0.5) * 1e4L;
  const double rest = static_cast<double>(std::remainder(angle, 4 * 3.14159265358979323846264338327950288L));
  const Vector end = integrate(model, neutral(model), Vector(w.normalized() * rest));
  CHECK(distance(model, end, s.q()) < static_cast<double>(steps) * u);
  CHECK(isNormalized(model, s.q(), 4 * u));
}

TEST_CASE("a ball joint turns through pi and on as a hinge does", "[motion]") {
  // The bodies rotate about y, from 3 rad, with enough speed to go round and round.
  const Vec3<double> com{0, 0, -0.7}, moments{0.3, 0.2, 0.25};
  const CompactModel ball = compile(tool::body("spherical", 1.5, com, moments, 9.81), registry());
  Model hinged = tool::body("revolute", 1.5, com, moments, 9.81);
  hinged.bodies[1].joint.parameters["axis"] = std::vector<double>{0, 1, 0};
  const CompactModel hinge = compile(hinged, registry());
  for (const IntegratorInfo& info : integrators()) {
    if (info.order < 2) continue;
    const SimulatorOptions options{.integrator = info.integrator, .dt = 0x1p-9, .tolerance = 1e-12};
    Simulator turning(ball, options), hinging(hinge, options);
    turning.reset(neutral(ball), Vector(Eigen::Vector3d(0, 15, 0)));
    hinging.reset(Vector::Zero(1), Vector::Constant(1, 15));
    double most = 0;
    for (int k = 1; k <= 40; ++k) {
      turning.advance(0.05 * k);
      hinging.advance(0.05 * k);
      const double half = 0.5 * hinging.q()[0];
      const Vector expected = (Vector(4) << 0, std::sin(half), 0, std::cos(half)).finished();
      most = std::max(most, largest(difference(ball, expected, turning.q())));
    }
    INFO(info.name << ", " << hinging.q()[0] << " rad");
    CHECK(hinging.q()[0] > 4 * M_PI);
    // Both joints have the same equations. Results differ by rounding and by the tolerances of iterations and steps.
    CHECK(most < (info.adaptive ? 1e-9 : 1e-11));
  }
}

TEST_CASE("how far off a robot stands does not change how its joints move, to the last bit", "[motion]") {
  urdf::Options options;
  options.root = "free_flyer";
  const CompactModel model = compile(urdf::load(DYN_SOURCE_DIR "/models/biped.urdf", options), registry());
  const int joints = model.nv() - 6;
  const auto moved = [&](double distance) {
    Simulator s(model, {.dt = 1e-3});
    Vector q = integrate(model, neutral(model), Vector::Constant(model.nv(), 0.2)), v = Vector::Constant(model.nv(), 0.3);
    q[0] = distance;
    q[1] = -distance;
    // The velocity of the base must not matter either.
    s.reset(q, v);
    s.advance(0.5);
    return Vector(s.q().tail(joints));
  };
  const Vector here = moved(0);
  for (const double distance : {1e6, 1e9}) CHECK((moved(distance) - here).cwiseAbs().maxCoeff() == 0);
}

TEST_CASE("the stiff governor needs no small steps", "[motion][stiff]") {
  DYN_NEEDS_SHARED();
  const Mechanism m = flyballGovernor();
  const nlohmann::json truth = truthFile("data/ref_flyball.json");
  const auto error = [&](Integrator integrator, double dt) {
    Simulator s(m.model, {.integrator = integrator, .dt = dt});
    s.setController([&](double, const VectorResult& q, const VectorResult& v, VectorMap tau) { tau = m.force(q, v); });
    s.reset(m.q, m.v);
    double worst = 0;
    for (const auto& state : truth["states"]) {
      s.advance(number(state["t"]));
      // The first oscillation dies in 1 ms. Long steps do not resolve it, so only later states are compared.
      if (number(state["t"]) >= 0.1) worst = std::max(worst, std::abs(s.q()[m.dof("slider")] - number(state["s"])));
    }
    return worst;
  };
  const double long_steps = error(Integrator::radau5, 1e-2), short_steps = error(Integrator::radau5, 2.5e-3);
  INFO(long_steps << ", " << short_steps);
  // With order five a quarter of the step gives a thousandth of the error, down to the rounding in 10 s of a motion of 1 m.
  CHECK(long_steps < 1e-6);
  CHECK(short_steps < long_steps / 100);
  // The damper's rate bounds explicit steps, whatever the accuracy.
  CHECK_THROWS_WITH(error(Integrator::rk4, 2.5e-3), containing("the step of 0.0025 s from t ="));
}

TEST_CASE("the adaptive pair keeps what it was asked for", "[motion][adaptive]") {
  DYN_NEEDS_SHARED();
  struct Task {
    std::string name;
    CompactModel model;
    State start, end;
    bool loop = false;
  };
  std::vector<Task> tasks;
  const std::vector<State> pendulum = pendulumReference(false), top = rigidReference("heavy_top");
  tasks.push_back({"pendulum", compile(tool::pendulum(2), registry()), pendulum[0], pendulum[2], false});
  tasks.push_back({"top", compile(tool::heavyTop(), registry()), top[0], top[1], false});
  {
    const Mechanism m = fourBars(1);
    State end{10, m.q, m.v};
    const double angle = number(truthFile("data/ref_pendula.json")["A02"]["1"]["theta10"]);
    for (const JointRecord& j : m.model.joints())
      if (j.nv > 0) end.q[j.idx_q] = j.name[1] == 'r' ? -angle : angle;
    tasks.push_back({"four-bar", m.model, {0, m.q, m.v}, end, true});
  }
  for (const char* robot : {"lwr", "hyq"}) {
    urdf::Options options;
    options.root = robot == std::string("hyq") ? "free_flyer" : "fixed";
    const Model description = urdf::load(sharedFolder() + "/models/" + robot + ".urdf", options);
    CompileOptions free;
    free.dissipation = free.armature = false;
    const CompactModel model = compile(description, registry(), free);
    tool::State start;
    start.q = integrate(model, neutral(model), Vector::Constant(model.nv(), 0.3));
    start.v = Vector::Constant(model.nv(), 0.2);
    // Six steps give the same doubles as twelve.
    const tool::State end = tool::Oracle(description, model).move(start, 0.25, 6);
    tasks.push_back({robot, model, {0, start.q, start.v}, {0.25, end.q, end.v}, false});
  }
  for (const Task& task : tasks) {
    const auto run = [&](const Vector& q, const Vector& v, double tolerance) {
      Simulator s(task.model, {.integrator = Integrator::dormand_prince, .tolerance = tolerance});
      s.reset(q, v);
      s.advance(task.end.time);
      return Vector(s.q());
    };
    // Growth of disturbances of the start, in one coordinate or velocity at a time. For a loop only its velocity is scaled, so that it stays closed.
    const Vector undisturbed = run(task.start.q, task.start.v, 1e-11);
    const double h = 1e-6;
    double growth = 1;
    const int n = task.model.nv();
    for (int k = 0; k < (task.loop ? 1 : 2 * n); ++k) {
      const Vector unit = Vector::Unit(n, k % n) * h;
      const Vector q = k < n && !task.loop ? integrate(task.model, task.start.q, unit) : task.start.q;
      const Vector v = task.loop ? Vector((1 + h) * task.start.v) : k < n ? task.start.v : Vector(task.start.v + unit);
      growth = std::max(growth, largest(difference(task.model, undisturbed, run(q, v, 1e-11))) / h);
    }
    for (const double tolerance : {1e-5, 1e-7, 1e-9}) {
      const double error = largest(difference(task.model, task.end.q, run(task.start.q, task.start.v, tolerance)));
      INFO(task.name << ": asked " << tolerance << ", error " << error << ", growth " << growth);
      CHECK(error < 10 * tolerance * growth);
    }
  }
}
