// Motions of closed loops, against digits that are known.
#include "integrate/problems.hpp"

#include <algorithm>

using namespace dyn;
using namespace dyn::test;

TEST_CASE("loops stay closed and keep their energy through positions where they are singular", "[motion][loops]") {
  DYN_NEEDS_SHARED();
  const int squares = GENERATE(1, 2, 10);
  const nlohmann::json truth = truthFile("data/ref_pendula.json")["A02"][std::to_string(squares)];
  const Mechanism m = fourBars(squares);
  Simulator s(m.model, {.integrator = Integrator::dormand_prince, .tolerance = 1e-11});
  s.reset(m.q, m.v);
  const double before = s.energy();
  double energy = 0, closure = 0;
  for (int k = 1; k <= 100; ++k) {
    s.advance(0.1 * k);
    energy = std::max(energy, std::abs(s.energy() - before));
    closure = std::max(closure, s.constraintError());
  }
  const double angle = -s.q()[m.dof("crank0")];
  INFO("energy " << energy << ", closure " << closure << ", steps " << s.statistics().steps);
  // The tolerance a step, over so many steps, times the mechanism's stiffness in J/rad.
  CHECK(energy < 1e-9 * number(truth["E0_above_base"]));
  CHECK(closure < 1e-12);
  CHECK(std::abs(angle - number(truth["theta10"])) < 1e-8);
}

TEST_CASE("Bricard's linkage and Andrews' squeezer move as the references do", "[motion][loops]") {
  DYN_NEEDS_SHARED();
  SECTION("Bricard") {
    const nlohmann::json truth = truthFile("data/ref_bricard.json");
    for (const char* name : {"bricard", "bricard_split"}) {
      const Mechanism m = bricard(name);
      Simulator s(m.model, {.integrator = Integrator::dormand_prince, .tolerance = 1e-11});
      s.reset(m.q, m.v);
      const double before = s.energy();
      for (const auto& state : truth["states"]) {
        s.advance(number(state["t"]));
        INFO(name << " at " << s.time() << " s");
        CHECK(largest(s.q() - numbers(state["q"])) < 1e-7);
        CHECK(std::abs(s.energy() - before) < 1e-8);
        CHECK(s.constraintError() < 1e-12);
      }
    }
  }
  SECTION("Andrews") {
    const Mechanism m = andrewsSqueezer();
    Simulator s(m.model, {.integrator = Integrator::dormand_prince, .dt = 1e-6, .tolerance = 1e-10});
    s.setController([&](double, const VectorResult& q, const VectorResult& v, VectorMap tau) { tau = m.force(q, v); });
    s.reset(m.q, m.v);
    const nlohmann::json truth = truthFile("data/ref_andrews.json");
    for (const auto& state : truth["states"]) {
      s.advance(number(state["t"]));
      for (std::size_t k = 0; k < andrews_order.size(); ++k) {
        INFO(andrews_order[k] << " at " << s.time() << " s");
        CHECK(std::abs(s.q()[m.dof(andrews_order[k])] - number(state["q"][k])) < 1e-7);
      }
    }
  }
}

TEST_CASE("every method follows loops with its order, through singular positions and with redundant rows", "[motion][loops]") {
  DYN_NEEDS_SHARED();
  struct Loop {
    std::string name;
    Mechanism mechanism;
    double time, dt;
    std::function<double(const Simulator&)> error;
  };
  std::vector<Loop> loops;
  {
    const Mechanism m = fourBars(1);
    const double angle = number(truthFile("data/ref_pendula.json")["A02"]["1"]["theta10"]);
    loops.push_back({"four-bar", m, 10, 1e-2, [m, angle](const Simulator& s) { return std::abs(-s.q()[m.dof("crank0")] - angle); }});
  }
  {
    const Mechanism m = bricard("bricard");
    const nlohmann::json states = truthFile("data/ref_bricard.json")["states"];
    const auto at = std::find_if(states.begin(), states.end(), [](const auto& state) { return number(state["t"]) == 2; });
    loops.push_back({"Bricard", m, 2, 1e-2, [q = numbers((*at)["q"])](const Simulator& s) { return largest(s.q() - q); }});
  }
  {
    const Mechanism m = andrewsSqueezer();
    const nlohmann::json states = truthFile("data/ref_andrews.json")["states"];
    const auto at = std::find_if(states.begin(), states.end(), [](const auto& state) { return number(state["t"]) == 0.03; });
    const auto error = [m, q = numbers((*at)["q"])](const Simulator& s) {
      double most = 0;
      for (std::size_t k = 0; k < andrews_order.size(); ++k)
        most = std::max(most, std::abs(s.q()[m.dof(andrews_order[k])] - q[static_cast<Eigen::Index>(k)]));
      return most;
    };
    loops.push_back({"Andrews", m, 0.03, 1.25e-5, error});
  }
  for (const Loop& loop : loops) {
    for (const IntegratorInfo& info : integrators()) {
      if (info.adaptive || info.order == 1) continue;
      const auto error = [&](double dt) {
        Simulator s(loop.mechanism.model, {.integrator = info.integrator, .dt = dt});
        s.setController([&](double, const VectorResult& q, const VectorResult& v, VectorMap tau) { tau = loop.mechanism.force(q, v); });
        s.reset(loop.mechanism.q, loop.mechanism.v);
        s.advance(loop.time);
        CHECK(s.constraintError() < 1e-12);
        return loop.error(s);
      };
      const double coarse = error(loop.dt), fine = error(loop.dt / 2);
      INFO(loop.name << ", " << info.name << ": " << coarse << ", " << fine);
      // To the order, or down to what is rounding in so many steps.
      CHECK(fine < std::max(std::exp2(-0.95 * info.order) * coarse, 1e-10));
      CHECK(coarse < 0.05);
    }
  }
}
