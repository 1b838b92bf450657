// SPDX-License-Identifier: BSD-2-Clause
// Behaviour that users of the simulator rely on: times, states between steps, events, saved and resumed runs, errors that leave the state unchanged.
#include "integrate/problems.hpp"
#include "support/random_model.hpp"
#include "support/saved.hpp"
#include "support/skip.hpp"

#include <dyn/algorithm/jacobians.hpp>
#include <dyn/parsers/urdf.hpp>

#include <alloc_guard.hpp>

using namespace dyn;
using namespace dyn::test;

namespace {

bool sameBytes(const VectorResult& a, const Vector& b) { return a.size() == b.size() && std::equal(a.begin(), a.end(), b.begin()); }

/// A random tree of many joint types, with a state in motion.
struct Tree {
  CompactModel model;
  Vector q, v;
  explicit Tree(int bodies = 12, std::uint64_t seed = 3) : model(compile(randomTree(groups(), bodies, seed), groups())) {
    Random random(seed);
    q = integrate(model, neutral(model), random.vector(model.nv(), 0.5));
    v = random.vector(model.nv(), 0.5);
  }
};

Vector pull(const VectorResult& q, const VectorResult& v) { return -0.3 * v - 0.1 * Vector::Ones(v.size()) * q[0]; }
void controller(double, const VectorResult& q, const VectorResult& v, VectorMap tau) { tau = pull(q, v); }

CompactModel pendulum() { return compile(tool::pendulum(1), registry()); }

}  // namespace

TEST_CASE("all methods go to the same place, as their steps become short", "[simulator]") {
  const Tree tree;
  const auto end = [&](Integrator integrator, double dt) {
    Simulator s(tree.model, {.integrator = integrator, .dt = dt, .tolerance = 1e-11});
    s.setController(controller);
    s.reset(tree.q, tree.v);
    s.advance(0.25);
    return Vector(s.q());
  };
  const Vector reference = end(Integrator::gauss6, 0x1p-9);
  const auto off = [&](Integrator integrator, double dt) { return distance(tree.model, reference, end(integrator, dt)); };
  CHECK(off(Integrator::radau5, 0x1p-9) < 1e-9);
  CHECK(off(Integrator::rk4, 0x1p-10) < 1e-7);
  CHECK(off(Integrator::dormand_prince, 0x1p-9) < 1e-8);
  for (const Integrator second : {Integrator::implicit_midpoint, Integrator::variational}) {
    const double coarse = off(second, 0x1p-9), fine = off(second, 0x1p-10);
    INFO(infoOf(second).name << " " << coarse << " " << fine);
    CHECK(fine < 1e-3);
    CHECK(std::abs(std::log2(coarse / fine) - 2) < 0.1);
  }
  for (const Integrator first : {Integrator::explicit_euler, Integrator::semi_implicit_euler}) {
    const double coarse = off(first, 0x1p-12), fine = off(first, 0x1p-13);
    CHECK(std::abs(std::log2(coarse / fine) - 1) < 0.05);
  }
}

TEST_CASE("the same inputs give the same bytes, whether or not states are watched", "[simulator]") {
  const Tree tree;
  for (const IntegratorInfo& info : integrators()) {
    const SimulatorOptions options{.integrator = info.integrator, .dt = 0x1p-8};
    Simulator plain(tree.model, options), watched(tree.model, options);
    for (Simulator* s : {&plain, &watched}) {
      s->setController(controller);
      s->reset(tree.q, tree.v);
    }
    plain.advance(0.1);
    int seen = 0;
    watched.advance(0.1, {0, 0.01, 0.0123, 0.05, 0.05, 0.1}, [&](double, const VectorResult&, const VectorResult&) { ++seen; });
    INFO(info.name);
    CHECK(seen == 6);
    CHECK(sameBytes(plain.q(), watched.q()));
    CHECK(sameBytes(plain.v(), watched.v()));
    CHECK(plain.time() == 0.1);
  }
}

TEST_CASE("a simulation that is saved and resumed goes on to the same bytes", "[simulator]") {
  const Tree tree;
  for (const IntegratorInfo& info : integrators()) {
    const SimulatorOptions options{.integrator = info.integrator, .dt = 1e-3};
    const auto drive = [](double t, const VectorResult& q, const VectorResult& v, VectorMap tau) { tau = std::sin(300 * t) * pull(q, v); };
    Simulator first(tree.model, options);
    first.setController(drive);
    first.reset(tree.q, tree.v, 0.3);
    for (int k = 0; k < 7; ++k) first.step();
    const std::string saved = first.save();
    first.advance(0.35);
    Simulator second(tree.model, options);
    second.setController(drive);
    second.resume(saved);
    CHECK(second.save() == saved);
    second.advance(0.35);
    INFO(info.name);
    CHECK(sameBytes(first.q(), second.q()));
    CHECK(sameBytes(first.v(), second.v()));
    CHECK(first.save() == second.save());
  }
}

TEST_CASE("resumed with steps of another length, time goes on from where it was saved", "[simulator]") {
  const CompactModel model = pendulum();
  for (const IntegratorInfo& info : integrators()) {
    Simulator coarse(model, {.integrator = info.integrator, .dt = 1e-2}), fine(model, {.integrator = info.integrator, .dt = 1e-3});
    coarse.reset(Vector::Constant(1, 0.25), Vector::Zero(1));
    coarse.advance(0.5);
    fine.resume(coarse.save());
    INFO(info.name);
    CHECK(fine.time() == 0.5);
    fine.step();
    CHECK(fine.time() > 0.5);
    fine.advance(0.6);
    CHECK(fine.time() == 0.6);
    if (!info.adaptive) CHECK(fine.statistics().steps == 100);
  }
}

TEST_CASE("what was not saved here is refused, and the simulator stays as it was", "[simulator]") {
  const CompactModel model = pendulum();
  Simulator s(model, {});
  s.reset(Vector::Constant(1, 0.25), Vector::Zero(1));
  const std::string saved = s.save();
  const auto refused = [&](const std::string& text, const std::string& why) {
    INFO(text);
    CHECK_THROWS_WITH(s.resume(text), containing(why));
    CHECK(s.save() == saved);
  };
  refused("", "heading");
  refused("something else", "no saved simulation");
  refused("libdyn-simulation-1" + saved.substr(saved.find(' ')), "this library reads 'libdyn-simulation-3'");
  for (std::size_t size = 30; size < saved.size(); ++size) refused(saved.substr(0, size), "cut short");
  refused(saved + " 1", "cut short");
  for (std::size_t at = saved.find('\n') + 1; at < saved.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string flipped = saved;
      flipped[at] = static_cast<char>(flipped[at] ^ (1 << bit));
      CHECK_THROWS_AS(s.resume(flipped), Error);
    }
  refused(sealed(bodyOf(saved) + "1\n"), "after the end");
  // The other model has the same number of coordinates but another gravity.
  Model other = tool::pendulum(1);
  other.gravity = {0, 0, -9};
  refused(Simulator(compile(other, registry()), {}).save(), "another model");
  std::string far = bodyOf(saved);
  far.replace(far.find("\n0\n"), 3, "\n9223372036854775807\n");
  refused(sealed(far), "steps of");
  refused(Simulator(model, {.integrator = Integrator::radau5}).save(), "radau5");
  refused(Simulator(compile(tool::pendulum(2), registry()), {}).save(), "q has 2 numbers, the model's 1");
  std::string broken = bodyOf(saved);
  broken.replace(broken.find("p-"), 1, "x");
  refused(sealed(broken), "is no number");
  s.setEvents({{"late", [](double t, const VectorResult&, const VectorResult&) {
                  if (t > 1) throw std::runtime_error("too late");
                  return 1.0;
                }}});
  Simulator later(model, {});
  later.reset(Vector::Constant(1, 0.25), Vector::Zero(1), 2);
  refused(later.save(), "too late");
}

TEST_CASE("a saved rotation of length zero is refused before anything is taken of it", "[simulator]") {
  const CompactModel top = compile(tool::heavyTop(), registry());
  Simulator s(top, {});
  const std::string sound = s.save(), body = bodyOf(sound), unit = "\n4\n0p+0\n0p+0\n0p+0\n1p+0\n";
  std::string zero = body;
  REQUIRE(zero.find(unit) != std::string::npos);
  zero.replace(zero.find(unit), unit.size(), "\n4\n0p+0\n0p+0\n0p+0\n0p+0\n");
  CHECK_THROWS_WITH(s.resume(sealed(zero)), containing("no rotation"));
  CHECK(s.save() == sound);
}

TEST_CASE("states between steps are of fourth order", "[simulator]") {
  const Tree tree(6, 5);
  const auto worst = [&](Integrator integrator, double dt) {
    Simulator coarse(tree.model, {.integrator = integrator, .dt = dt, .tolerance = 1e3}),
        fine(tree.model, {.integrator = Integrator::gauss6, .dt = 0x1p-9});
    coarse.reset(tree.q, tree.v);
    fine.reset(tree.q, tree.v);
    double most = 0;
    const double whole = integrator == Integrator::dormand_prince ? dt : 4 * dt;  // at this tolerance steps would grow
    std::vector<double> times;
    for (int k = 1; k < 16; ++k) times.push_back(whole * k / 16);
    coarse.advance(whole, times, [&](double t, const VectorResult& q, const VectorResult& v) {
      fine.advance(t);
      most = std::max({most, distance(tree.model, fine.q(), q), (fine.v() - v).norm()});
    });
    return most;
  };
  for (const Integrator integrator : {Integrator::rk4, Integrator::gauss6, Integrator::dormand_prince}) {
    const double coarse = worst(integrator, 0x1p-4), fine = worst(integrator, 0x1p-5);
    INFO(infoOf(integrator).name << ": " << coarse << ", " << fine);
    CHECK(std::log2(coarse / fine) > 3.5);
  }
}

TEST_CASE("whole steps keep their grid, and the last one ends where it was asked to", "[simulator]") {
  const CompactModel model = pendulum();
  Simulator s(model, {.dt = 0.1});
  s.advance(0.95);
  CHECK(s.time() == 0.95);
  CHECK(s.statistics().steps == 10);
  Simulator grid(model, {.dt = 0.1});
  for (int k = 0; k < 1000; ++k) grid.step();
  CHECK(grid.time() == 1000 * 0.1);
  for (int k = 1; k <= 10; ++k) grid.advance(100 + 0.1 * k);  // 100.1 and the like are not exact multiples of dt
  CHECK(grid.statistics().steps == 1010);
}

TEST_CASE("adaptive steps end where they are asked to, however sums of their lengths are rounded", "[simulator]") {
  const CompactModel slider = compile(tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 0), registry());
  const auto [dt, end] = GENERATE(std::pair{0.0055, 0.1705}, std::pair{0.011, 1.716});
  Simulator s(slider, {.integrator = Integrator::dormand_prince, .dt = dt});
  s.advance(end);
  CHECK(s.time() == end);
  s.advance(end + 1e-15);
  CHECK(s.time() == end + 1e-15);
}

TEST_CASE("events are found where they happen, once, in their direction", "[simulator][event]") {
  const CompactModel model = pendulum();
  const Integrator integrator = GENERATE(Integrator::rk4, Integrator::dormand_prince, Integrator::gauss6);
  Simulator s(model, {.integrator = integrator, .dt = 0.01, .tolerance = 1e-12});
  s.reset(Vector::Constant(1, 0.5), Vector::Zero(1));
  const auto height = [](double, const VectorResult& q, const VectorResult&) { return q[0]; };
  s.setEvents({{"down", height, Event::Direction::falling}, {"up", height, Event::Direction::rising}});
  // A quarter of the period 4 K(sin(q0 / 2)) / w, by the arithmetic-geometric mean.
  double a = 1, b = std::cos(0.25);
  for (int k = 0; k < 6; ++k) {
    const double next = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = next;
  }
  const double quarter = M_PI / (2 * a) / std::sqrt(9.81);
  for (int k = 0; k < 6; ++k) {
    CHECK(s.advance(100) == k % 2);
    CHECK(std::abs(s.time() - (2 * k + 1) * quarter) < 1e-7);
    CHECK(std::abs(s.q()[0]) < 1e-10);
  }
  // This event never happens, so the simulation goes on to the end.
  s.setEvents({{"never", [](double, const VectorResult& q, const VectorResult&) { return q[0] + 1; }}});
  CHECK(s.advance(s.time() + 3) == -1);
}

TEST_CASE("events of one time, and events before one that others have, are each told once", "[simulator][event]") {
  // A stone is thrown up from 0. It passes 0.8 m twice and reaches the top in between, all within one step of the adaptive method.
  const CompactModel stone = compile(tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 9.81), registry());
  const auto above = [](double, const VectorResult& q, const VectorResult&) { return q[2] - 0.8; };
  const auto rises = [](double, const VectorResult&, const VectorResult& v) { return v[2]; };
  const auto early = [](double t, const VectorResult&, const VectorResult&) { return t - 0.1; };
  const double up = 5, top = up / 9.81, wide = std::sqrt(top * top - 2 * 0.8 / 9.81);
  for (const Integrator integrator : {Integrator::rk4, Integrator::dormand_prince, Integrator::gauss6})
    for (const double dt : {0.003, 0.7}) {
      INFO(infoOf(integrator).name << ", " << dt);
      Simulator s(stone, {.integrator = integrator, .dt = dt});
      s.reset(Vector::Zero(3), Vector(Eigen::Vector3d(0, 0, up)));
      s.setEvents({{"top", rises, Event::Direction::falling},
                   {"at 0.8 m", above},
                   {"once more", above, Event::Direction::rising},
                   {"early", early},
                   {"never falls", early, Event::Direction::falling}});
      std::vector<std::pair<int, double>> told;
      for (int event = s.advance(2); event >= 0; event = s.advance(2)) {
        told.emplace_back(event, s.time());
        REQUIRE(told.size() < 10);
      }
      const std::vector<std::pair<int, double>> expected{{3, 0.1}, {1, top - wide}, {2, top - wide}, {0, top}, {1, top + wide}};
      REQUIRE(told.size() == expected.size());
      for (std::size_t k = 0; k < told.size(); ++k) {
        CHECK(told[k].first == expected[k].first);
        CHECK(std::abs(told[k].second - expected[k].second) < 1e-9);
      }
      CHECK(s.time() == 2);
    }
  // An event that counts only in the other direction does not stop the simulation, whatever its sign changes within a step.
  Simulator s(stone, {.integrator = Integrator::dormand_prince, .dt = 0.9});
  s.reset(Vector::Zero(3), Vector(Eigen::Vector3d(0, 0, up)));
  s.setEvents({{"falls below 0.8 m", above, Event::Direction::falling}});
  CHECK(s.advance(2) == 0);
  CHECK(std::abs(s.time() - top - wide) < 1e-9);
}

TEST_CASE("a step tells nothing of what happened before it", "[simulator][event]") {
  const CompactModel stone = compile(tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 9.81), registry());
  const auto early = [](double t, const VectorResult&, const VectorResult&) { return t - 0.1; };
  Simulator s(stone, {.integrator = Integrator::rk4, .dt = 0.003});
  s.setEvents({{"one", early}, {"the other", early}});
  REQUIRE(s.advance(2) == 0);
  s.step();
  CHECK(s.advance(0.2) == -1);
}

TEST_CASE("what damping brings to rest stays there, however small its speed becomes", "[simulator]") {
  // Speeds reach the smallest positive numbers after 0.36 s.
  Model wheel = tool::body("revolute", 1, {}, {0.01, 0.01, 0.01}, 0);
  wheel.bodies[1].joint.parameters["axis"] = std::vector<double>{0, 0, 1};
  wheel.bodies[1].joint.damping = {20};
  const CompactModel model = compile(wheel, registry(), {.dissipation = true});
  for (const IntegratorInfo& info : integrators()) {
    if (!info.implicit) continue;
    INFO(info.name);
    for (const double speed : {3.0, 1e-290, 5e-324}) {
      Simulator s(model, {.integrator = info.integrator, .dt = 5e-4});
      s.reset(Vector::Constant(1, 0.1), Vector::Constant(1, speed));
      s.advance(0.6);
      CHECK(std::abs(s.v()[0]) < 1e-290);
    }
  }
}

TEST_CASE("an adaptive step that was cut short says nothing of the next", "[simulator]") {
  const CompactModel model = pendulum();
  Simulator s(model, {.integrator = Integrator::dormand_prince, .dt = 0.01});
  s.reset(Vector::Constant(1, 0.5), Vector::Zero(1));
  s.advance(1);
  const long before = s.statistics().steps;
  s.advance(std::nextafter(1.0, 2.0));
  s.advance(2);
  CHECK(s.statistics().steps - before < 80);
  // A body lies on the ground, and the caller advances by dt each time.
  Simulator lying(compile(tool::body("translation", 1, {}, {0.1, 0.1, 0.1}, 9.81), registry()),
                  {.integrator = Integrator::dormand_prince, .dt = 0.003});
  lying.setContacts(pointsOnPlane(lying.model(), {"body"}));
  for (int k = 1; k <= 1000; ++k) lying.advance(0.003 * k);
  CHECK(lying.statistics().steps < 1100);
}

TEST_CASE("steps that time does not resolve, or that would never end, are refused", "[simulator][error]") {
  const CompactModel model = pendulum();
  for (const double dt : {1e-300, 1e-14}) {
    Simulator s(model, {.dt = dt});
    CHECK_THROWS_WITH(s.advance(1), containing("would never end"));
  }
  Simulator late(model, {.dt = 1e-9});
  late.reset(Vector::Zero(1), Vector::Zero(1), 1e9);
  CHECK_THROWS_WITH(late.advance(1e9 + 1e-6), containing("less than what tells two times apart"));
  CHECK_THROWS_WITH(late.step(), containing("take a longer one"));
  // For adaptive methods dt is only the first step.
  Simulator adaptive(model, {.integrator = Integrator::dormand_prince, .dt = 1e-14});
  adaptive.reset(Vector::Constant(1, 0.5), Vector::Zero(1));
  CHECK(adaptive.advance(1) == -1);
}

TEST_CASE("callbacks that give what is not finite are told by what they gave, for whom", "[simulator][error]") {
  const Tree tree;
  const JointRecord& joint = tree.model.joints()[2];
  for (const Integrator integrator : {Integrator::rk4, Integrator::radau5, Integrator::semi_implicit_euler}) {
    Simulator s(tree.model, {.integrator = integrator});
    s.reset(tree.q, tree.v);
    s.setController([&](double t, const VectorResult&, const VectorResult&, VectorMap tau) {
      if (t > 0.01) tau[joint.idx_v] = std::numeric_limits<double>::infinity();
    });
    CHECK_THROWS_WITH(s.advance(1), containing("tau[" + std::to_string(joint.idx_v) + "], of joint '" + joint.name + "', is inf"));
    Simulator blown(tree.model, {.integrator = integrator});
    blown.reset(tree.q, tree.v);
    blown.setForces([&](double, const VectorResult&, const VectorResult&, Force<double>* f, int) { f[2].linear.y = std::nan(""); });
    CHECK_THROWS_WITH(blown.advance(1), containing("the external force on joint '" + joint.name + "' is not finite"));
  }
}

TEST_CASE("forces on bodies act as their generalised forces", "[simulator]") {
  const Tree tree;
  const CompactModel& m = tree.model;
  const Force<double> push{{1, -2, 0.5}, {0.1, 0.2, -0.3}};
  const int joint = m.njoints() - 1;
  for (const Integrator integrator : {Integrator::rk4, Integrator::radau5, Integrator::variational}) {
    Simulator by_forces(m, {.integrator = integrator, .dt = 0x1p-7}), by_torques(m, {.integrator = integrator, .dt = 0x1p-7});
    by_forces.setForces([&](double, const VectorResult&, const VectorResult&, Force<double>* f, int count) { f[count - 1] = push; });
    Data data(m, Need::derivatives);
    ExternalForces fext(m.joints().size());
    fext[static_cast<std::size_t>(joint)] = push;
    by_torques.setController([&](double, const VectorResult& q, const VectorResult&, VectorMap tau) {
      const Vector still = Vector::Zero(m.nv());
      tau = Vector(rnea(m, data, q, still, still)) - Vector(rnea(m, data, q, still, still, fext));
    });
    for (Simulator* s : {&by_forces, &by_torques}) {
      s->reset(tree.q, tree.v);
      s->advance(0.1);
    }
    INFO(infoOf(integrator).name);
    CHECK(distance(m, by_forces.q(), by_torques.q()) < 1e-11);
  }
}

TEST_CASE("a controller's own derivatives change iterations, not results", "[simulator]") {
  const Tree tree;
  const int n = tree.model.nv();
  Simulator differences(tree.model, {.integrator = Integrator::radau5, .dt = 0x1p-7}),
      given(tree.model, {.integrator = Integrator::radau5, .dt = 0x1p-7});
  const auto damper = [](double, const VectorResult&, const VectorResult& v, VectorMap tau) { tau = -2 * v; };
  long calls = 0;
  differences.setController(damper);
  given.setController(damper, [&](double, const VectorResult&, const VectorResult&, const MatrixMap&, MatrixMap by_v) {
    ++calls;
    by_v.diagonal().setConstant(-2);
  });
  for (Simulator* s : {&differences, &given}) {
    s->reset(tree.q, tree.v);
    s->advance(0.125);
  }
  CHECK(calls >= 16);
  CHECK((differences.v() - given.v()).cwiseAbs().maxCoeff() < 1e-11 * n);
}

TEST_CASE("closed loops of the description are kept by every method", "[simulator][loops]") {
  const Mechanism m = fourBars(1);
  for (const IntegratorInfo& info : integrators()) {
    Simulator s(m.model, {.integrator = info.integrator, .dt = 1e-3});
    s.reset(m.q, m.v);
    s.advance(0.5);
    INFO(info.name);
    CHECK(s.constraintError() < 1e-12);
    CHECK(std::abs(s.q()[m.dof("crank0")]) > 0.5);
  }
}

TEST_CASE("what makes no sense is refused when the simulator is made or asked", "[simulator][error]") {
  const CompactModel model = pendulum();
  for (const double dt : {0.0, -1e-3, std::nan(""), HUGE_VAL}) CHECK_THROWS_WITH(Simulator(model, {.dt = dt}), containing("must be positive"));
  for (const Integrator any : {Integrator::dormand_prince, Integrator::rk4})
    CHECK_THROWS_WITH(Simulator(model, {.integrator = any, .tolerance = 0}), containing("tolerance"));
  CHECK_THROWS_WITH(integratorByName("euler"), containing("semi_implicit_euler"));
  Simulator s(model, {});
  s.advance(0.5);
  CHECK_THROWS_WITH(s.advance(0.25), containing("time goes forward"));
  CHECK_THROWS_WITH(s.advance(std::nan("")), containing("time goes forward"));
  const Observer nothing = [](double, const VectorResult&, const VectorResult&) {};
  CHECK_THROWS_WITH(s.advance(1, {0.7, 0.6}, nothing), containing("time 1 is 0.6"));
  CHECK_THROWS_WITH(s.advance(1, {0.1}, nothing), containing("time 0 is 0.1"));
  CHECK_THROWS_WITH(s.setEvents({{"empty", nullptr}}), containing("'empty' has no function"));
  CHECK_THROWS_WITH(s.reset(Vector::Zero(2), Vector::Zero(1)), containing("q"));
  CHECK_THROWS_WITH(s.reset(Vector::Constant(1, std::nan("")), Vector::Zero(1)), containing("joint 'j1'"));
  const CompactModel top = compile(tool::heavyTop(), registry());
  Simulator spinning(top, {});
  CHECK_THROWS_WITH(spinning.reset(Vector::Zero(4), Vector::Zero(3)), containing("joint"));
}

TEST_CASE("a motion that cannot go on names time and joint, and leaves the state before it", "[simulator][error]") {
  const CompactModel model = pendulum();
  const auto fails = [&](const SimulatorOptions& options, const Controller& controller, const std::string& why) {
    Simulator s(model, options);
    s.setController(controller);
    s.reset(Vector::Constant(1, 0.5), Vector::Zero(1));
    std::vector<double> times, kept;
    for (int k = 0; k <= 100; ++k) times.push_back(0.01 * k);
    std::string message;
    try {
      s.advance(1, times, [&](double t, const VectorResult&, const VectorResult&) { kept.push_back(t); });
    } catch (const Error& e) {
      CHECK(e.code() == ErrorCode::simulation);
      message = e.what();
    }
    INFO(infoOf(options.integrator).name);
    CHECK_THAT(message, containing(why));
    CHECK_THAT(message, containing("t = "));
    CHECK(s.q().allFinite());
    CHECK(s.v().allFinite());
    CHECK(s.time() >= 0.1);
    CHECK(s.time() < 0.7);
    REQUIRE(!kept.empty());
    CHECK(kept.back() <= s.time());
    CHECK(kept.back() > s.time() - 0.0101);
  };
  const Controller throws = [](double t, const VectorResult&, const VectorResult&, const VectorMap&) {
    if (t > 0.5) throw std::runtime_error("out of torque");
  };
  const Controller odd = [](double t, const VectorResult&, const VectorResult&, const VectorMap&) {
    if (t > 0.5) throw 42;
  };
  const Controller nan = [](double t, const VectorResult&, const VectorResult&, VectorMap tau) {
    if (t > 0.5) tau[0] = std::nan("");
  };
  // dv/dt is about 10 v^2 from v = 1 or so, so v is infinite before 0.6 s.
  const Controller blows = [](double t, const VectorResult&, const VectorResult& v, VectorMap tau) { tau[0] = t < 0.2 ? 5 : 50 * (v[0] * v[0] + 1); };
  for (const IntegratorInfo& info : integrators()) {
    const SimulatorOptions options{.integrator = info.integrator, .dt = 1e-3};
    fails(options, throws, "the controller threw at t = 0.50");
    fails(options, odd, "no exception of the standard library");
    fails(options, nan, "the controller's tau[0], of joint 'j1', is nan");
  }
  fails({.integrator = Integrator::dormand_prince}, blows, "collapsed");
  Simulator s(model, {});
  s.setForces([](double, const VectorResult&, const VectorResult&, Force<double>*, int) { throw std::runtime_error("no wind"); });
  CHECK_THROWS_WITH(s.step(), containing("no wind"));
  Simulator watched(model, {});
  CHECK_THROWS_WITH(watched.advance(1, {0.5}, [](double, const VectorResult&, const VectorResult&) { throw std::runtime_error("disk full"); }),
                    containing("the observer threw at t = 0.5 s: disk full"));
}

TEST_CASE("callbacks may read their simulation, and not step, reset or change it", "[simulator][error]") {
  const CompactModel model = pendulum();
  Simulator s(model);
  const Vector q = neutral(model), v = Vector::Zero(model.nv());
  const std::pair<const char*, std::function<void()>> calls[] = {{"Simulator::reset", [&] { s.reset(q, v); }},
                                                                 {"Simulator::advance", [&] { s.advance(2); }},
                                                                 {"Simulator::step", [&] { s.step(); }},
                                                                 {"Simulator::resume", [&] { s.resume(s.save()); }},
                                                                 {"Simulator::setForces", [&] { s.setForces({}); }},
                                                                 {"Simulator::setController", [&] { s.setController({}); }},
                                                                 {"Simulator::setEvents", [&] { s.setEvents({}); }},
                                                                 {"Simulator::setContacts", [&] { s.setContacts({}); }}};
  for (const auto& [name, call] : calls) {
    INFO(name);
    s.setController([&call = call](double, VectorResult, VectorResult, VectorMap) { call(); });
    const std::string says = std::string(name) + ": it is called by a callback";
    CHECK_THROWS_WITH(s.advance(s.time() + 0.1), containing(says));
    s.setController({});
    CHECK_THROWS_WITH(s.advance(s.time() + 0.1, {s.time() + 0.05}, [&call = call](double, VectorResult, VectorResult) { call(); }), containing(says));
    s.advance(s.time() + 0.1, {s.time() + 0.05}, [&](double, VectorResult, VectorResult) { s.energy(); });
  }
}

TEST_CASE("a stiff motion that no explicit step can follow ends with the joint's name", "[simulator][error]") {
  Model description = tool::pendulum(1);
  description.bodies[1].joint.damping = {1e12};
  const CompactModel model = compile(description, registry());
  Simulator s(model, {.integrator = Integrator::dormand_prince});
  s.reset(neutral(model), Vector::Constant(model.nv(), 1));
  try {
    s.advance(1);
    FAIL("it went through");
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::simulation);
    CHECK(e.where().joint == description.bodies[1].joint.name);
    CHECK_THAT(e.what(), containing("stiff") && containing("radau5"));
  }
  CHECK(s.time() > 0);
}

TEST_CASE("no step allocates", "[simulator][no_alloc]") {
  if (!dyn::tool::canCountAllocations()) DYN_SKIP("a sanitizer owns malloc in this build");
  const Tree tree(25, 4);
  const Mechanism loop = fourBars(2);
  const auto check = [](Simulator& s, const std::string& name) {
    s.setController([](double, const VectorResult&, const VectorResult& v, VectorMap tau) { tau = -0.1 * v; });
    s.step();
    const long before = dyn::tool::allocationCount();
    for (int k = 0; k < 5; ++k) s.step();
    const long made = dyn::tool::allocationCount() - before;
    INFO(name);
    CHECK(made == 0);
  };
  for (const IntegratorInfo& info : integrators()) {
    Simulator free(tree.model, {.integrator = info.integrator});
    free.reset(tree.q, tree.v);
    check(free, info.name);
    Simulator constrained(loop.model, {.integrator = info.integrator});
    constrained.reset(loop.q, loop.v);
    check(constrained, std::string(info.name) + " with loops");
  }
}
