// SPDX-License-Identifier: BSD-2-Clause
// Mechanisms with closed loops whose motion is known to many digits (IFToMM's benchmark problems). They move for seconds, pass through singular
// positions or have loops that are redundant everywhere.
#include "support/mechanisms.hpp"

#include "constraint/support.hpp"
#include "gragg.hpp"

#include <dyn/parsers/urdf.hpp>

#include <cmath>

using namespace dyn;
using namespace dyn::test;

namespace {

/// A mechanism simulated by a method of order 12 that is independent of the library's own integrators.
struct Run : Mechanism {
  Data data;
  ConstraintData loops;

  explicit Run(const Mechanism& m) : Mechanism(m), data(model, Need::derivatives), loops(ConstraintSet(model)) {}

  Vector acceleration(const Vector& at_q, const Vector& at_v) { return constraintDynamics(model, data, at_q, at_v, force(at_q, at_v), loops).ddq; }
  double energy() { return computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q); }
  double error() { return computeConstraintMotion(model, data, q, v, loops).error.cwiseAbs().maxCoeff(); }

  /// One step of Gragg's extrapolation, of order 12, then a projection onto the loops.
  void step(double h) {
    Vector x(2 * q.size());
    x << q, v;
    x = tool::extrapolate<6>(x, h, [&](const Vector& y) {
      const Vector p = y.head(q.size()), w = y.tail(q.size());
      Vector out(y.size());
      out << w, acceleration(p, w);
      return out;
    });
    q = x.head(q.size());
    v = x.tail(v.size());
    if (loops.set().rows() == 0) return;
    q = projectConfiguration(model, data, q, loops).q;
    v = projectVelocity(model, data, q, v, loops);
  }
  void run(double time, int steps) {
    for (int i = 0; i < steps; ++i) step(time / steps);
  }
};

}  // namespace

TEST_CASE("four-bars pass through the position where their bars are in line", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const int squares = GENERATE(1, 2, 10);
  const nlohmann::json truth = truthFile("data/ref_pendula.json")["A02"][std::to_string(squares)];
  Run m(fourBars(squares));
  const double before = m.energy();
  double worst = 0, drift = 0;
  for (int i = 0; i < 1000; ++i) {
    m.step(0.01);
    worst = std::max(worst, std::abs(m.energy() - before));
    drift = std::max(drift, m.error());
  }
  const double theta = -m.q[m.model.joints()[static_cast<std::size_t>(m.model.jointId("crank0"))].idx_q];
  const double expected = std::stod(truth["theta10"].get<std::string>());
  INFO("energy " << worst << ", closure " << drift << ", angle off by " << theta - expected);
  // The bound is 1e-9 J for one square, and the same part of the energy for more squares.
  CHECK(worst < 5e-11 * std::stod(truth["E0_above_base"].get<std::string>()));
  CHECK(drift < 1e-12);
  CHECK(std::abs(theta - expected) < 1e-8);
  CHECK(std::abs(std::sin(theta) - std::stod(truth["B0x10"].get<std::string>())) < 1e-8);
  CHECK(std::abs(std::cos(theta) - std::stod(truth["B0y10"].get<std::string>())) < 1e-8);
}

TEST_CASE("where bars are all but in line, the loop's row along them is not taken for one of its own", "[mechanism]") {
  // A force along the bars has no moment arm. The little motion that it causes is rounding, and a force that held this row would be without bound.
  Run m(fourBars(1));
  for (double off = 1e-4; off > 1e-16; off /= 10) {
    INFO(off << " rad off");
    const double turned = M_PI / 2 - off;
    for (int k = 0; k < 3; ++k) {
      m.q[k] = (k == 1 ? 1 : -1) * turned;
      m.v[k] = k == 1 ? 4.88 : -4.88;
    }
    for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
      const ConstrainedMotion x = constraintDynamics(m.model, m.data, m.q, m.v, Vector::Zero(3), m.loops, method);
      CHECK(x.rank == (off > 5e-5 ? 2 : 1));
      CHECK(x.lambda.norm() < 20);
      // Leaving out the row changes the accelerations by no more than first order in `off`.
      for (int k = 0; k < 3; ++k) CHECK(std::abs(x.ddq[k] - (k == 1 ? 1 : -1) * 1.2 * 9.81 * std::cos(off)) < 1e-9 + 100 * off);
    }
  }
}

TEST_CASE("a closed loop keeps its energy as the same mechanism without loops does", "[mechanism]") {
  // The parallelogram moves as a single crank with the inertia of two cranks and the coupler's mass at its end.
  Run loop(fourBars(1));
  Model single;
  single.gravity = {0, -9.81, 0};
  const double I = 1.0 / 12;
  const Inertia<double> crank{1, {0, 0.5, 0}, {I, 0, 0, 0, 0, I}};
  tool::addBar(single, "crank", 0, {0, 0, 1}, {}, crank + crank + Inertia<double>{1, {0, 1, 0}, {}});
  Run minimal{Mechanism(single)};
  minimal.v[0] = -1;
  const auto worstOf = [](Run& m) {
    const double before = m.energy();
    double worst = 0;
    // The steps are so long that the method's error dominates rounding.
    for (int i = 0; i < 60; ++i) {
      m.step(10.0 / 60);
      worst = std::max(worst, std::abs(m.energy() - before));
    }
    return worst;
  };
  const double of_loop = worstOf(loop), of_minimal = worstOf(minimal);
  INFO("loop " << of_loop << ", minimal " << of_minimal);
  CHECK(of_minimal > 1e-9);
  CHECK(of_loop <= 2 * of_minimal);
  CHECK(std::abs(loop.q[0] - minimal.q[0]) < 1e-6);
}

TEST_CASE("Bricard's linkage moves although its loop is redundant everywhere", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json truth = truthFile("data/ref_bricard.json");
  const std::string name = GENERATE(as<std::string>{}, "bricard", "bricard_split");
  Run m(bricard(name));
  const ConstrainedMotion x = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops);
  CHECK(m.loops.set().rows() == (name == "bricard" ? 5 : 6));
  CHECK(x.rank == m.loops.set().rows() - 1);
  CHECK(x.residual < 1e-13);
  for (Eigen::Index k = 0; k < 5; ++k) CHECK(std::abs(x.ddq[k] - (k % 2 == 0 ? 1.962 : -1.962)) < 1e-14);
  if (name == "bricard") {
    // The reference has rows in world axes, linear ones first. It gives the moments that act on the world but the forces that act on the rod.
    for (Eigen::Index k = 0; k < 5; ++k)
      CHECK(std::abs((k < 3 ? 1 : -1) * x.lambda[k] - std::stod(truth["lam0_min_norm"][static_cast<std::size_t>(k)].get<std::string>())) < 1e-13);
  }
  const double before = m.energy();
  double now = 0, worst = 0, drift = 0;
  for (const auto& state : truth["states"]) {
    const double t = std::stod(state["t"].get<std::string>());
    const int steps = static_cast<int>(std::lround((t - now) * 100));
    for (int i = 0; i < steps; ++i) {
      m.step((t - now) / steps);
      worst = std::max(worst, std::abs(m.energy() - before));
      drift = std::max(drift, m.error());
    }
    now = t;
    for (Eigen::Index k = 0; k < 5; ++k) {
      INFO(name << " at " << t << " s, joint " << k);
      CHECK(std::abs(m.q[k] - std::stod(state["q"][static_cast<std::size_t>(k)].get<std::string>())) < 1e-8);
      CHECK(std::abs(m.v[k] - std::stod(state["v"][static_cast<std::size_t>(k)].get<std::string>())) < 1e-7);
    }
  }
  INFO("energy " << worst << ", closure " << drift);
  CHECK(worst < 1e-9);
  CHECK(drift < 1e-12);
}

TEST_CASE("Andrews' squeezer moves as the reference does", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json truth = truthFile("data/ref_andrews.json");
  Run m(andrewsSqueezer());
  const auto dof = [&](int k) { return m.dof(andrews_order[static_cast<std::size_t>(k)]); };
  const ConstrainedMotion x = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops);
  for (int k = 0; k < 7; ++k) CHECK(std::abs(x.ddq[dof(k)] - number(truth["a0"][static_cast<std::size_t>(k)])) < 1e-10 * 14222);
  for (int r = 0; r < 6; ++r) CHECK(std::abs(x.lambda[r] + number(truth["lambda0"][static_cast<std::size_t>(r)])) < 1e-10 * 98.6);
  double now = 0;
  for (const auto& state : truth["states"]) {
    const double t = number(state["t"]);
    m.run(t - now, static_cast<int>(std::lround((t - now) * 50000)));
    now = t;
    for (int k = 0; k < 7; ++k) {
      INFO(andrews_order[static_cast<std::size_t>(k)] << " at " << t << " s");
      CHECK(std::abs(m.q[dof(k)] - number(state["q"][static_cast<std::size_t>(k)])) < 1e-9 * 34);
      CHECK(std::abs(m.v[dof(k)] - number(state["v"][static_cast<std::size_t>(k)])) < 1e-9 * 1400);
    }
    const Vector lambda = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops).lambda;
    for (int r = 0; r < 6; ++r) CHECK(std::abs(lambda[r] + number(state["lam"][static_cast<std::size_t>(r)])) < 1e-8 * 200);
  }
}

TEST_CASE("the flyball governor moves as the reference does", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const nlohmann::json truth = truthFile("data/ref_flyball.json");
  Run m(flyballGovernor());
  const int slider = m.dof("slider"), rods[2] = {m.dof("rod0"), m.dof("rod1")};
  double now = 0;
  for (const auto& state : truth["states"]) {
    const double t = std::stod(state["t"].get<std::string>());
    m.run(t - now, std::max(1, static_cast<int>(std::lround((t - now) / (t <= 0.01 ? 1e-4 : 5e-4)))));  // the first oscillation dies in 1 ms
    now = t;
    INFO("at " << t << " s");
    CHECK(std::abs(m.q[slider] - std::stod(state["s"].get<std::string>())) < 1e-9);
    CHECK(std::abs(m.v[slider] - std::stod(state["s_dot"].get<std::string>())) < 1e-8);
    for (const int rod : rods) CHECK(std::abs(m.q[rod] - std::stod(state["beta"].get<std::string>())) < 1e-9);
  }
}

TEST_CASE("straight legs that cannot keep their feet where they are give the least residual", "[mechanism]") {
  DYN_NEEDS_SHARED();
  urdf::Options options;
  options.root = "free_flyer";
  CompileOptions no_losses;
  no_losses.dissipation = false;
  const CompactModel model = compile(urdf::load(sharedFolder() + "/models/hyq.urdf", options), registry(), no_losses);
  Data data(model, Need::derivatives);
  ConstraintData c(ConstraintSet(model, {pointContact("lf_foot"), pointContact("rf_foot"), pointContact("lh_foot"), pointContact("rh_foot")}));
  int met = 0;
  const nlohmann::json truth = truthFile("data/hyq.json");
  for (const auto& sample : truth["samples"]) {
    const auto vector = [&](const char* key) {
      const auto x = sample[key].get<std::vector<double>>();
      return Vector(Eigen::Map<const Vector>(x.data(), static_cast<Eigen::Index>(x.size())));
    };
    const bool straight = sample["note"] == "neutral configuration";
    met += straight;
    for (const ConstraintMethod method : {ConstraintMethod::articulated, ConstraintMethod::kkt}) {
      const ConstrainedMotion x = constraintDynamics(model, data, vector("q"), vector("v"), vector("tau"), c, method);
      CHECK(x.rank == (straight ? 11 : 12));
      CHECK(std::abs(x.residual - (straight ? 0.63 : 0.0)) < (straight ? 0.005 : 1e-9));
      CHECK(x.lambda.cwiseAbs().maxCoeff() < 1000);
    }
  }
  CHECK(met == 1);
}

TEST_CASE("redundant contacts of robots have the rank and the motion of those that are enough", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const auto load = [](const std::string& robot) {
    urdf::Options options;
    options.root = "free_flyer";
    return compile(urdf::load(sharedFolder() + "/models/" + robot + ".urdf", options), registry());
  };
  const auto renamed = [](ConstraintDescription c, const std::string& name, const Vec3<double>& point = {}) {
    c.name = name;
    std::get<FrameConstraint>(c.relation).placement.p = point;
    return c;
  };
  const auto solve = [](const CompactModel& model, const std::vector<ConstraintDescription>& set, std::uint64_t seed) {
    Data data(model);
    ConstraintData c(ConstraintSet(model, set));
    Random random(seed);
    const Vector q = randomConfiguration(model, seed), tau = random.vector(model.nv(), 5);
    const ConstrainedMotion x = constraintDynamics(model, data, q, Vector::Zero(model.nv()), tau, c);
    CHECK(x.lambda.allFinite());
    CHECK(x.residual <= 1e-9);
    return std::pair(x.rank, Vector(x.ddq));
  };
  const auto same = [](const Vector& a, const Vector& b) { return (a - b).cwiseAbs().maxCoeff() <= 1e-9 * b.cwiseAbs().maxCoeff(); };

  const CompactModel hyq = load("hyq"), talos = load("talos");
  std::vector<ConstraintDescription> feet, twice;
  for (const char* foot : {"lf_foot", "rf_foot", "lh_foot", "rh_foot"}) {
    feet.push_back(pointContact(foot));
    twice.push_back(pointContact(foot));
    twice.push_back(renamed(pointContact(foot), std::string(foot) + " again"));
  }
  std::vector<ConstraintDescription> soles, corners;
  for (const char* sole : {"left_sole_link", "right_sole_link"}) {
    soles.push_back(frameContact(sole));
    for (int k = 0; k < 4; ++k)
      corners.push_back(renamed(pointContact(sole), sole + std::to_string(k), {k < 2 ? 0.1 : -0.1, k % 2 ? 0.06 : -0.06, 0}));
  }
  std::vector<ConstraintDescription> line;
  line.reserve(3);
  for (int k = 0; k < 3; ++k) line.push_back(renamed(pointContact("left_sole_link"), "point" + std::to_string(k), {0.1 * k, 0, 0}));
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    const auto [rank, ddq] = solve(hyq, feet, seed);
    const auto [rank_twice, ddq_twice] = solve(hyq, twice, seed);
    CHECK(rank == 12);
    CHECK(rank_twice == 12);
    CHECK(same(ddq_twice, ddq));
    const auto [rank_soles, ddq_soles] = solve(talos, soles, seed);
    const auto [rank_corners, ddq_corners] = solve(talos, corners, seed);
    CHECK(rank_soles == 12);
    CHECK(rank_corners == 12);
    CHECK(same(ddq_corners, ddq_soles));
    CHECK(solve(talos, line, seed).first == 5);
    CHECK(solve(talos, {soles[0], renamed(frameContact("left_sole_link"), "again")}, seed).first == 6);
    // Two points on one leg keep their distance anyway, so one of six rows is redundant.
    CHECK(solve(hyq, {feet[0], renamed(pointContact("lf_foot"), "shin", {0.1, 0, 0})}, seed).first == 5);
  }
}
