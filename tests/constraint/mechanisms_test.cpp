// Mechanisms with closed loops whose motion is known to many digits (IFToMM's benchmark problems): through singular positions, with loops
// that are redundant everywhere, over seconds.
#include "constraint/support.hpp"
#include "support/registry.hpp"
#include "support/shared.hpp"
#include "support/truth_model.hpp"

#include <dyn/parsers/urdf.hpp>

#include <cmath>
#include <fstream>
#include <functional>

using namespace dyn;
using namespace dyn::test;

namespace {

using Vector = Eigen::VectorXd;

nlohmann::json truthFile(const std::string& path) { return nlohmann::json::parse(std::ifstream(sharedFolder() + "/truth/" + path)); }

/// Loops of the reference models. Their rows are point (3), hinge (5) or frame (6).
std::vector<ConstraintDescription> loopsOf(const nlohmann::json& document) {
  std::vector<ConstraintDescription> out;
  for (const auto& loop : document["loops"]) {
    const auto body = [&](const char* key) {
      const std::string name = loop[key];
      return name == "universe" ? name : name + "_link";
    };
    const auto vector = [&](const char* key) {
      const auto x = loop[key].get<std::vector<double>>();
      return Vec3<double>{x[0], x[1], x[2]};
    };
    std::array<bool, 6> free{};
    const std::string type = loop["type"];
    if (type == "3D") free = {false, false, false, true, true, true};
    if (type == "revolute") {
      const Vec3<double> axis = vector("axis");
      for (int k = 0; k < 3; ++k) free[static_cast<std::size_t>(3 + k)] = axis[k] != 0;
    }
    ConstraintDescription d = closeLoop("loop" + std::to_string(out.size()), body("a"), body("b"), free);
    auto& c = std::get<FrameConstraint>(d.relation);
    c.placement.p = vector("pa");
    c.other_placement.p = vector("pb");
    out.push_back(d);
  }
  return out;
}

/// A mechanism whose joints have one degree of freedom each, and its state.
struct Mechanism {
  CompactModel model;
  Data data;
  ConstraintData loops;
  std::function<Vector(const Vector& q, const Vector& v)> force;
  Vector q, v;

  Mechanism(const Model& description, const std::vector<ConstraintDescription>& constraints)
      : model(compile(description, registry())),
        data(model, Need::derivatives),
        loops(ConstraintSet(model, constraints)),
        force([n = model.nv()](const Vector&, const Vector&) { return Vector(Vector::Zero(n)); }),
        q(neutral(model)),
        v(Vector::Zero(model.nv())) {}

  Vector acceleration(const Vector& at_q, const Vector& at_v) { return constraintDynamics(model, data, at_q, at_v, force(at_q, at_v), loops).ddq; }
  double energy() { return computeKineticEnergy(model, data, q, v) + computePotentialEnergy(model, data, q); }
  double error() { return computeConstraintMotion(model, data, q, v, loops).error.cwiseAbs().maxCoeff(); }

  /// One step of Gragg's extrapolation, order 2 k, then back onto the loops.
  void step(double h) {
    constexpr int k = 6;
    Vector T[k][k], x(2 * q.size());
    x << q, v;
    const auto rate = [&](const Vector& y) {
      const Vector p = y.head(q.size()), w = y.tail(q.size());
      Vector out(y.size());
      out << w, acceleration(p, w);
      return out;
    };
    const Vector start = rate(x);
    for (int j = 0; j < k; ++j) {
      const int n = 2 * (j + 1);
      Vector before = x, now = x + h / n * start;
      for (int i = 1; i < n; ++i) {
        const Vector next = before + 2 * h / n * rate(now);
        before = now;
        now = next;
      }
      T[j][0] = 0.5 * (now + before + h / n * rate(now));
      for (int l = 1; l <= j; ++l) {
        const double ratio = static_cast<double>((j + 1) * (j + 1)) / ((j - l + 1) * (j - l + 1));
        T[j][l] = T[j][l - 1] + (T[j][l - 1] - T[j - 1][l - 1]) / (ratio - 1);
      }
    }
    q = T[k - 1][k - 1].head(q.size());
    v = T[k - 1][k - 1].tail(v.size());
    if (loops.set().rows() == 0) return;
    q = projectConfiguration(model, data, q, loops).q;
    v = projectVelocity(model, data, q, v, loops);
  }
  void run(double time, int steps) {
    for (int i = 0; i < steps; ++i) step(time / steps);
  }
};

int addBar(Model& model, const std::string& name, int parent, const std::vector<double>& axis, const Vec3<double>& at, const Inertia<double>& Y) {
  JointDescription joint;
  joint.name = name;
  joint.type = "revolute";
  joint.parameters["axis"] = axis;
  joint.placement.p = at;
  return model.addBody(name + "_link", parent, joint, Y);
}

/// N unit squares of unit rods side by side, upright: the first crank, then a coupler and a crank for each.
Mechanism fourBars(int squares) {
  Model model;
  model.gravity = {0, -9.81, 0};
  const double I = 1.0 / 12;
  const Inertia<double> crank{1, {0, 0.5, 0}, {I, 0, 0, 0, 0, I}}, coupler{1, {0.5, 0, 0}, {0, 0, 0, I, 0, I}};
  std::vector<ConstraintDescription> loops;
  int above = addBar(model, "crank0", 0, {0, 0, 1}, {}, crank);
  for (int k = 1; k <= squares; ++k) {
    // A coupler from the top of the crank before, and a crank that hangs on the ground.
    const std::string n = std::to_string(k);
    addBar(model, "coupler" + n, above, {0, 0, 1}, {0, 1, 0}, coupler);
    above = addBar(model, "crank" + n, 0, {0, 0, 1}, {static_cast<double>(k), 0, 0}, crank);
    ConstraintDescription d = closeLoop("loop" + n, "coupler" + n + "_link", "crank" + n + "_link", {false, false, false, true, true, true});
    std::get<FrameConstraint>(d.relation).placement.p = {1, 0, 0};
    std::get<FrameConstraint>(d.relation).other_placement.p = {0, 1, 0};
    loops.push_back(d);
  }
  Mechanism m(model, loops);
  // B0, the top of the first crank, moves at 1 m/s to the right: all cranks turn, couplers keep their direction.
  for (const JointRecord& j : m.model.joints()) {
    if (j.nv == 0) continue;
    m.v[j.idx_v] = j.name[1] == 'r' ? -1 : 1;
  }
  return m;
}

}  // namespace

TEST_CASE("four-bars pass through the position where their bars are in line", "[mechanism]") {
  DYN_NEEDS_SHARED();
  const int squares = GENERATE(1, 2, 10);
  const nlohmann::json truth = truthFile("data/ref_pendula.json")["A02"][std::to_string(squares)];
  Mechanism m = fourBars(squares);
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
  // 1e-9 J for one square, and as much of the energy of more.
  CHECK(worst < 5e-11 * std::stod(truth["E0_above_base"].get<std::string>()));
  CHECK(drift < 1e-12);
  CHECK(std::abs(theta - expected) < 1e-8);
  CHECK(std::abs(std::sin(theta) - std::stod(truth["B0x10"].get<std::string>())) < 1e-8);
  CHECK(std::abs(std::cos(theta) - std::stod(truth["B0y10"].get<std::string>())) < 1e-8);
}

TEST_CASE("a closed loop keeps its energy as the same mechanism without loops does", "[mechanism]") {
  // The parallelogram moves as one crank with the coupler's mass at its end and two cranks' inertia.
  Mechanism loop = fourBars(1);
  Model single;
  single.gravity = {0, -9.81, 0};
  const double I = 1.0 / 12;
  const Inertia<double> crank{1, {0, 0.5, 0}, {I, 0, 0, 0, 0, I}};
  addBar(single, "crank", 0, {0, 0, 1}, {}, crank + crank + Inertia<double>{1, {0, 1, 0}, {}});
  Mechanism minimal(single, {});
  minimal.v[0] = -1;
  const auto worstOf = [](Mechanism& m) {
    const double before = m.energy();
    double worst = 0;
    // Steps so long that the method's error is what is compared, not the rounding.
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
  const nlohmann::json document = truthFile("models/" + name + ".json");
  Mechanism m(readTruthModel(document), loopsOf(document));
  const ConstrainedMotion x = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops);
  CHECK(m.loops.set().rows() == (name == "bricard" ? 5 : 6));
  CHECK(x.rank == m.loops.set().rows() - 1);
  CHECK(x.residual < 1e-13);
  for (Eigen::Index k = 0; k < 5; ++k) CHECK(std::abs(x.ddq[k] - (k % 2 == 0 ? 1.962 : -1.962)) < 1e-14);
  if (name == "bricard") {
    // The reference has its rows in world axes, linear ones first; it counts moments on the world and forces on the rod.
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
  // Parameters of the test set for initial value problems (Hairer and Wanner 1996, sec. VII.7).
  constexpr double d = 28e-3, da = 0.0115, e = 0.02, ea = 0.01421, rr = 7e-3, ra = 0.92e-3, ss = 0.035, sa = 0.01874, sb = 0.01043, sc = 0.018,
                   sd = 0.02, ta = 0.02308, tb = 0.00916, u = 0.04, ua = 0.01228, ub = 0.00449, zf = 0.02, zt = 0.04, fa = 0.01421, c0 = 4530,
                   l0 = 0.07785, moment = 0.033;
  const Vec3<double> A{-0.06934, -0.00227, 0}, B{-0.03635, 0.03273, 0}, C{0.014, 0.072, 0};
  const auto plane = [](double m, double I, double x, double y) { return Inertia<double>{m, {x, y, 0}, {0, 0, 0, 0, 0, I}}; };
  Model model;
  model.gravity = {};
  const std::vector<double> z{0, 0, 1};
  const int beta = addBar(model, "beta", 0, z, {}, plane(0.04325, 2.194e-6, ra, 0));
  addBar(model, "theta", beta, z, {rr, 0, 0}, plane(0.00365, 4.410e-7, -da, 0));
  addBar(model, "gamma", 0, z, B, plane(0.02373, 5.255e-6, sa, sb));
  const int delta = addBar(model, "delta", 0, z, A, plane(0.07050, 1.169e-5, ta, tb));
  addBar(model, "phi", delta, z, {zt, 0, 0}, plane(0.00706, 5.667e-7, 0, -(e - ea)));
  const int epsilon = addBar(model, "epsilon", 0, z, A, plane(0.05498, 1.912e-5, ua, -ub));
  addBar(model, "omega", epsilon, z, {0, -u, 0}, plane(0.00706, 5.667e-7, zf - fa, 0));
  std::vector<ConstraintDescription> loops;
  const std::pair<const char*, Vec3<double>> ends[] = {{"gamma_link", {0, -ss, 0}}, {"phi_link", {0, -e, 0}}, {"omega_link", {zf, 0, 0}}};
  for (const auto& [body, point] : ends) {
    ConstraintDescription loop = closeLoop(body, "theta_link", body, {false, false, true, true, true, true});
    auto& c = std::get<FrameConstraint>(loop.relation);
    c.placement.p = {-d, 0, 0};
    c.other_placement.p = point;
    c.axes = ConstraintAxes::LOCAL_WORLD_ALIGNED;
    loops.push_back(loop);
  }
  Mechanism m(model, loops);
  // The reference's order is beta, theta, gamma, phi, delta, omega, epsilon.
  const char* order[] = {"beta", "theta", "gamma", "phi", "delta", "omega", "epsilon"};
  const auto dof = [&](int k) { return m.model.joints()[static_cast<std::size_t>(m.model.jointId(order[k]))].idx_v; };
  const auto number = [](const nlohmann::json& x) { return std::stod(x.get<std::string>()); };
  for (int k = 0; k < 7; ++k) m.q[dof(k)] = number(truth["q0"][static_cast<std::size_t>(k)]);
  const int i_beta = dof(0), i_gamma = dof(2), n = m.model.nv();
  m.force = [&](const Vector& q, const Vector&) {
    const double g = q[i_gamma], xd = sd * std::cos(g) + sc * std::sin(g) + B.x - C.x, yd = sd * std::sin(g) - sc * std::cos(g) + B.y - C.y;
    const double length = std::hypot(xd, yd), pull = -c0 * (length - l0) / length;
    Vector tau = Vector::Zero(n);
    tau[i_beta] = moment;
    tau[i_gamma] = pull * (xd * (sc * std::cos(g) - sd * std::sin(g)) + yd * (sd * std::cos(g) + sc * std::sin(g)));
    return tau;
  };
  const ConstrainedMotion x = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops);
  for (int k = 0; k < 7; ++k) CHECK(std::abs(x.ddq[dof(k)] - number(truth["a0"][static_cast<std::size_t>(k)])) < 1e-10 * 14222);
  for (int r = 0; r < 6; ++r) CHECK(std::abs(x.lambda[r] + number(truth["lambda0"][static_cast<std::size_t>(r)])) < 1e-10 * 98.6);
  double now = 0;
  for (const auto& state : truth["states"]) {
    const double t = number(state["t"]);
    m.run(t - now, static_cast<int>(std::lround((t - now) * 50000)));
    now = t;
    for (int k = 0; k < 7; ++k) {
      INFO(order[k] << " at " << t << " s");
      CHECK(std::abs(m.q[dof(k)] - number(state["q"][static_cast<std::size_t>(k)])) < 1e-9 * 34);
      CHECK(std::abs(m.v[dof(k)] - number(state["v"][static_cast<std::size_t>(k)])) < 1e-9 * 1400);
    }
    const Vector lambda = constraintDynamics(m.model, m.data, m.q, m.v, m.force(m.q, m.v), m.loops).lambda;
    for (int r = 0; r < 6; ++r) CHECK(std::abs(lambda[r] + number(state["lam"][static_cast<std::size_t>(r)])) < 1e-8 * 200);
  }
}

TEST_CASE("the flyball governor moves as the reference does", "[mechanism]") {
  DYN_NEEDS_SHARED();
  // A shaft, a slider on it, two rods with balls; spring-dampers of 0.5 m at rest tie the slider to the rods' middles. Stiff: 1.5 ms.
  constexpr double K = 8e5, C = 4e4, length = 0.5, middle = 0.5;
  const nlohmann::json truth = truthFile("data/ref_flyball.json"), document = truthFile("models/flyball.json");
  Model model;
  const auto inertiaOf = [](const nlohmann::json& b) {
    const auto c = b["com"].get<std::vector<double>>();
    const auto I = b.contains("inertia") ? b["inertia"].get<std::vector<double>>() : std::vector<double>(6, 0.0);
    return Inertia<double>{b["mass"].get<double>(), {c[0], c[1], c[2]}, {I[0], I[1], I[2], I[3], I[4], I[5]}};
  };
  std::map<std::string, int> bodies{{"universe", 0}};
  for (const auto& j : document["joints"]) {
    Inertia<double> Y;
    if (j.contains("bodies")) {
      for (const auto& b : j["bodies"]) Y = Y + inertiaOf(b);
    } else {
      Y = inertiaOf(j);
    }
    const std::string name = j["name"];
    bodies[name] = model.addBody(name + "_link", bodies.at(j["parent"]), jointOf(j, "fly"), Y);
  }
  Mechanism m(model, {});
  const auto dof = [&](const char* name) { return m.model.joints()[static_cast<std::size_t>(m.model.jointId(name))].idx_v; };
  const int slider = dof("slider"), rods[2] = {dof("rod0"), dof("rod1")}, shaft = dof("shaft");
  m.q[slider] = 0.5;
  for (const int rod : rods) m.q[rod] = M_PI / 6;
  m.v[shaft] = 2 * M_PI;
  m.force = [&, n = m.model.nv()](const Vector& q, const Vector& v) {
    Vector tau = Vector::Zero(n);
    for (const int rod : rods) {
      // In the rod's plane, from the slider's end, as far from the shaft as the rod hangs, to the middle of the rod; up is z.
      const double c = std::cos(q[rod]), s = std::sin(q[rod]), x = middle * c, z = 1 - middle * s - q[slider];
      const double dx = -middle * s * v[rod], dz = -middle * c * v[rod] - v[slider];
      const double l = std::hypot(x, z), pull = K * (l - length) + C * (x * dx + z * dz) / l;
      tau[rod] += -pull / l * (x * -middle * s + z * -middle * c);
      tau[slider] += pull / l * z;
    }
    return tau;
  };
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
    // Two points of one leg keep their distance by themselves.
    CHECK(solve(hyq, {feet[0], renamed(pointContact("lf_foot"), "shin", {0.1, 0, 0})}, seed).first == 5);
  }
}
