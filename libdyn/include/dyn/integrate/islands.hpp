// A scene of mechanisms that do not touch each other, each simulated alone, and not at all while it rests.
#pragma once

#include <dyn/compile/compile.hpp>
#include <dyn/integrate/simulator.hpp>
#include <dyn/owned.hpp>

#include <string>
#include <vector>

namespace dyn {

/// When an island may be left alone: no speed of a joint above this [rad/s, m/s], and no acceleration that would lead above it, for this long [s].
struct SleepOptions {
  bool allowed = false;
  double speed = 1e-6;
  double time = 0.5;
};

/// Islands are trees on the world, with what constraints, couplings and `scene.touching` tie to them. Each has its own CompactModel and Simulator,
/// with the steps that it needs. A sleeping one costs nothing and stays where it was, at rest; woken it goes on from there.
class DYN_API IslandSimulator {
 public:
  /// As compile() and Simulator; of `options.scene` with outputs only islands that have one.
  IslandSimulator(const Model& model, const JointRegistry& registry, const CompileOptions& options, const SimulatorOptions& simulation,
                  const SleepOptions& sleep = {});
  ~IslandSimulator();
  IslandSimulator(IslandSimulator&&) noexcept;
  IslandSimulator& operator=(IslandSimulator&&) noexcept;

  int count() const;
  /// For its state, controller and contacts. Changing them does not wake it: see wake().
  Simulator& island(int k);
  /// The island that has this joint, body or frame; -1 if none has.
  int islandOf(const std::string& name) const;
  bool asleep(int k) const;
  /// What happens to it, an impulse, a new controller, makes it move again from now on.
  void wake(int k);

  /// That all islands have come to.
  double time() const;
  /// All islands to this time, one after the other, each as Simulator::advance; their events do not end it. Those that may fall asleep are looked
  /// at every tenth of `sleep.time`. Throws as Simulator::advance: time() is then what all have come to, and those that are past it wait there.
  void advance(double until);

  /// What was left out, how many islands there are.
  const std::vector<std::string>& report() const;

 private:
  struct Impl;
  Owned<Impl> impl_;
};

}  // namespace dyn
