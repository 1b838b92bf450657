// SPDX-License-Identifier: BSD-2-Clause
#include "number_text.hpp"

#include <dyn/error.hpp>
#include <dyn/integrate/islands.hpp>

#include <algorithm>
#include <cmath>

namespace dyn {

struct IslandSimulator::Impl {
  struct Island {
    Simulator simulator;
    double quiet_since = 0;
    bool asleep = false;
  };
  SleepOptions sleep;
  std::vector<Island> islands;
  std::vector<std::string> report;
  double time = 0;

  Island& at(int k) {
    if (k < 0 || k >= static_cast<int>(islands.size()))
      throw Error(ErrorCode::argument, "IslandSimulator: island " + std::to_string(k) + " of " + std::to_string(islands.size()));
    return islands[static_cast<std::size_t>(k)];
  }

  /// True if the island rests and will go on resting: its accelerations do not lead above sleep.speed within sleep.time.
  bool quiet(Island& x) const {
    const VectorResult v = x.simulator.v();
    if (v.size() == 0) return true;
    if (!(v.cwiseAbs().maxCoeff() <= sleep.speed)) return false;
    // The smooth equations of motion ignore contacts and would accelerate a body on the ground, so only its speed counts.
    if (x.simulator.touches()) return true;
    return x.simulator.acceleration().cwiseAbs().maxCoeff() * sleep.time <= sleep.speed;
  }

  void look(Island& x) {
    if (!quiet(x)) {
      x.quiet_since = time;
    } else if (time - x.quiet_since >= sleep.time) {
      x.asleep = true;
      const Eigen::VectorXd q = x.simulator.q(), still = Eigen::VectorXd::Zero(x.simulator.model().nv());
      x.simulator.reset(q, still, time);
    }
  }
};

IslandSimulator::IslandSimulator(const Model& model, const JointRegistry& registry, const CompileOptions& options, const SimulatorOptions& simulation,
                                 const SleepOptions& sleep)
    : impl_(std::make_unique<Impl>()) {
  if (sleep.allowed && (!(sleep.speed >= 0) || !(sleep.time > 0)))
    throw Error(ErrorCode::argument, "IslandSimulator: islands fall asleep below a speed that is not negative, after a time that is positive");
  impl_->sleep = sleep;
  const Model wanted = keepForScene(model, options.scene, impl_->report);
  CompileOptions each = options;
  // Keep only the names in scene.touching that are still in the scene.
  std::erase_if(each.scene.touching, [&](const std::string& name) {
    const auto named = [&](const FrameDescription& frame) { return frame.name == name; };
    return wanted.findBody(name) < 0 && wanted.findJoint(name) < 0 && std::none_of(wanted.frames.begin(), wanted.frames.end(), named);
  });
  for (const std::string& root : islandsOf(wanted, each.scene.touching)) {
    each.scene.outputs = {root};
    const CompactModel compact = compile(wanted, registry, each);
    impl_->islands.push_back({Simulator(compact, simulation)});
  }
  impl_->report.push_back("islands: " + std::to_string(impl_->islands.size()));
}

IslandSimulator::~IslandSimulator() = default;
IslandSimulator::IslandSimulator(IslandSimulator&&) noexcept = default;
IslandSimulator& IslandSimulator::operator=(IslandSimulator&&) noexcept = default;

int IslandSimulator::count() const { return static_cast<int>(impl_->islands.size()); }
Simulator& IslandSimulator::island(int k) { return impl_->at(k).simulator; }
bool IslandSimulator::asleep(int k) const { return impl_->at(k).asleep; }
double IslandSimulator::time() const { return impl_->time; }
const std::vector<std::string>& IslandSimulator::report() const { return impl_->report; }

int IslandSimulator::islandOf(const std::string& name) const {
  for (std::size_t k = 0; k < impl_->islands.size(); ++k) {
    const CompactModel& model = impl_->islands[k].simulator.model();
    if (name != "universe" && (model.findJoint(name) > 0 || model.findFrame(name) > 0)) return static_cast<int>(k);
  }
  return -1;
}

void IslandSimulator::wake(int k) {
  Impl::Island& x = impl_->at(k);
  x.quiet_since = impl_->time;
  if (!x.asleep) return;
  x.asleep = false;
  const Eigen::VectorXd q = x.simulator.q(), v = x.simulator.v();
  x.simulator.reset(q, v, impl_->time);
}

void IslandSimulator::advance(double until) {
  Impl& x = *impl_;
  if (!std::isfinite(until) || until < x.time)
    throw Error(ErrorCode::argument,
                "IslandSimulator::advance: to t = " + number(until) + " s, but it is " + number(x.time) + " s: time goes forward");
  while (x.time < until) {
    const double next = x.sleep.allowed ? std::min(until, x.time + 0.1 * x.sleep.time) : until;
    for (Impl::Island& island : x.islands) {
      // An event ends the simulator's advance, but not that of the scene. An island that is ahead, because another one threw, waits.
      while (!island.asleep && island.simulator.time() < next) island.simulator.advance(next);
    }
    x.time = next;
    if (!x.sleep.allowed) continue;
    for (Impl::Island& island : x.islands)
      if (!island.asleep) x.look(island);
  }
}

}  // namespace dyn
