// SPDX-License-Identifier: BSD-2-Clause
// Motions of closed loops compared with accurate references.
#include "integrate/problems.hpp"
#include "support/random_model.hpp"

#include <dyn/parsers/urdf.hpp>

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
  // The bound is the tolerance of a step, times the number of steps and the mechanism's stiffness in J/rad.
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
      // The error falls with the method's order, or down to the rounding of so many steps.
      CHECK(fine < std::max(std::exp2(-0.95 * info.order) * coarse, 1e-10));
      CHECK(coarse < 0.05);
    }
  }
}

namespace {

/// Lengths of the bars of a four-bar linkage on a sliding carriage. If the longest and the shortest bar together are as long as the other two, the
/// linkage can fold flat and unfold in two ways.
struct FoldingBars {
  double crank, coupler, rocker, ground;
};

struct FoldingMotion {
  CompactModel model;
  Vector q, v;
};

FoldingMotion fold(const FoldingBars& bars, std::uint64_t seed) {
  Random random(seed);
  Model model;
  const auto bar = [&](const char* name, int parent, double at, double length) {
    const double mass = random.uniform(0.3, 1.3), I = mass * length * length / 12;
    return tool::addBar(model, name, parent, {0, 0, 1}, {at, 0, 0}, {mass, {length / 2, 0, 0}, {0, 0, 0, I, 0, I}});
  };
  JointDescription slide;
  slide.name = "carriage";
  slide.type = "prismatic";
  slide.parameters["axis"] = std::vector<double>{1, 0, 0};
  const int carriage = model.addBody("carriage_link", 0, slide, {random.uniform(1, 2), {}, {1e-3, 0, 0, 1e-3, 0, 1e-3}});
  bar("coupler", bar("crank", carriage, 0, bars.crank), bars.crank, bars.coupler);
  bar("rocker", carriage, bars.ground, bars.rocker);
  ConstraintDescription loop = closeLoop("loop", "coupler_link", "rocker_link", {false, false, false, true, true, true});
  std::get<FrameConstraint>(loop.relation).placement.p = {bars.coupler, 0, 0};
  std::get<FrameConstraint>(loop.relation).other_placement.p = {bars.rocker, 0, 0};
  model.constraints.push_back(loop);
  model.gravity = {};
  FoldingMotion out{compile(model, registry()), Vector::Zero(4), Vector::Zero(4)};
  // Coupler and rocker meet above the line from the crank's end to the rocker's foot.
  const double angle = random.uniform(0.6, 1.6), x = bars.crank * std::cos(angle), y = bars.crank * std::sin(angle);
  const double far = std::hypot(bars.ground - x, y), along = (far * far + bars.coupler * bars.coupler - bars.rocker * bars.rocker) / (2 * far);
  const double up = std::sqrt(bars.coupler * bars.coupler - along * along), down = std::atan2(-y, bars.ground - x);
  const double coupler = down + std::atan2(up, along);
  const double meet_x = x + bars.coupler * std::cos(coupler), meet_y = y + bars.coupler * std::sin(coupler);
  const auto put = [&](const char* joint, double value) {
    out.q[out.model.joints()[static_cast<std::size_t>(out.model.jointId(joint))].idx_q] = value;
  };
  put("crank", angle);
  put("coupler", coupler - angle);
  put("rocker", std::atan2(meet_y, meet_x - bars.ground));
  // The loop need not allow this velocity, because the first projection corrects it.
  out.v << 0, random.uniform(4, 8), -5, 1;
  return out;
}

}  // namespace

TEST_CASE("loops that fold flat go on along their branch, or it is said that a step is too long", "[loops][branches]") {
  for (const FoldingBars& bars : {FoldingBars{0.3, 0.5, 0.4, 0.6}, FoldingBars{0.25, 0.25, 0.6, 0.6}, FoldingBars{0.45, 0.35, 0.5, 0.6}})
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const FoldingMotion motion = fold(bars, seed);
      for (const Integrator integrator : {Integrator::radau5, Integrator::gauss6, Integrator::rk4, Integrator::dormand_prince})
        for (const double dt : {0.02, 0.01}) {
          Simulator s(motion.model, {.integrator = integrator, .dt = dt, .tolerance = 1e-5});
          s.reset(motion.q, motion.v);
          s.advance(1e-6);
          const double before = s.energy();
          double worst = 0;
          INFO(bars.crank << ", seed " << seed << ", integrator " << static_cast<int>(integrator) << ", dt " << dt);
          try {
            for (int k = 1; k <= 100; ++k) {
              s.advance(0.03 * k);
              worst = std::max(worst, std::abs(s.energy() - before));
            }
          } catch (const Error& e) {
            CHECK(e.code() == ErrorCode::simulation);
            CHECK_THAT(e.what(), containing("cannot be taken") || containing("no smooth motion"));
          }
          CHECK(worst < 0.06 * before);
          CHECK(s.constraintError() < 1e-12);
        }
    }
}

TEST_CASE("sudden forces, stiff dampers and starts that loops do not allow are not taken for another branch", "[loops][branches]") {
  const FoldingMotion motion = fold({0.2, 0.5, 0.45, 0.5}, 3);
  for (const Integrator integrator : {Integrator::radau5, Integrator::gauss6, Integrator::rk4, Integrator::semi_implicit_euler}) {
    Simulator s(motion.model, {.integrator = integrator, .dt = 1e-3});
    INFO(static_cast<int>(integrator));
    const double start = 0.0123, end = 0.0456;
    s.setController([&](double t, const VectorResult&, const VectorResult&, VectorMap tau) {
      tau.setZero();
      tau[1] = t > start && t < end ? 3 : 0;
    });
    s.reset(motion.q, Vector::Zero(4));  // at rest until the sudden force acts
    s.advance(0.1);
    CHECK(s.statistics().rejected == 0);
    s.reset(motion.q, motion.v);  // a velocity that the loop does not allow
    s.advance(0.01);
    CHECK(s.statistics().rejected == 0);
  }
  // A swinging mechanism turns back where it is slow.
  const CompactModel swing = compile(urdf::load(DYN_SOURCE_DIR "/models/four_bar.urdf"), registry());
  for (const IntegratorInfo& info : integrators()) {
    if (info.adaptive) continue;
    INFO(info.name);
    Simulator s(swing, {.integrator = info.integrator, .dt = 1e-3});
    s.advance(1.5);
    CHECK(s.statistics().rejected == 0);
  }
  Simulator stiff(motion.model, {.integrator = Integrator::radau5, .dt = 1e-2});
  stiff.reset(motion.q, motion.v);
  stiff.advance(1e-6);
  stiff.setController([](double, const VectorResult&, const VectorResult& v, VectorMap tau) { tau = -30 * v; });
  const double before = stiff.energy();
  stiff.advance(0.1);
  CHECK(stiff.energy() < 0.2 * before);
  CHECK(stiff.statistics().rejected == 0);
}
