// SPDX-License-Identifier: BSD-2-Clause
// Simulation of a scene of mechanisms that do not touch each other: each is simulated alone, and not at all while it is at rest.
#pragma once

#include <dyn/compile/compile.hpp>
#include <dyn/integrate/simulator.hpp>
#include <dyn/owned.hpp>

#include <string>
#include <vector>

namespace dyn {

/// When islands stop being simulated. An island falls asleep when, for `time` [s], no joint is faster than `speed` [rad/s, m/s] and no acceleration
/// would lead above that speed within `time`. Islands in which something touches are judged by speed alone.
struct SleepOptions {
  bool allowed = false;  ///< islands may fall asleep
  double speed = 1e-6;   ///< [rad/s, m/s]
  double time = 0.5;     ///< [s]
};

/// Simulates a scene island by island. An island is a tree on the world together with all trees that constraints, couplings or `scene.touching` tie
/// to it. Each island has its own CompactModel and Simulator, and takes the steps that it needs. A sleeping island costs nothing and stays where it
/// is, with zero velocity; once woken, it goes on from there.
class DYN_API IslandSimulator {
 public:
  /// Takes arguments and throws as compile() and Simulator. If `options.scene` has outputs, only islands with an output are simulated. Throws
  /// Error(argument) for a sleep speed that is negative or a sleep time that is not positive.
  IslandSimulator(const Model& model, const JointRegistry& registry, const CompileOptions& options, const SimulatorOptions& simulation,
                  const SleepOptions& sleep = {});
  ~IslandSimulator();
  IslandSimulator(IslandSimulator&&) noexcept;
  IslandSimulator& operator=(IslandSimulator&&) noexcept;

  /// Returns the number of islands.
  int count() const;
  /// Gives access to an island's state, controller and contacts. Changing them does not wake the island: see wake(). This, asleep()
  /// and wake() throw Error(argument) for a number out of range.
  Simulator& island(int k);
  /// Returns the number of the island that has this joint, body or frame; -1 if none has it.
  int islandOf(const std::string& name) const;
  /// Returns whether an island sleeps.
  bool asleep(int k) const;
  /// Lets an island move again from the present time. Call this after an impulse or a new controller.
  void wake(int k);

  /// Returns the time [s] that all islands have reached.
  double time() const;
  /// Advances all islands to this time, one after the other, each by Simulator::advance; their events do not end it. If sleep is allowed, islands are
  /// examined every tenth of `sleep.time`. Throws as Simulator::advance: time() is then the time that all islands have reached, and islands beyond it
  /// wait there.
  void advance(double until);

  /// Says what was left out, and how many islands there are.
  const std::vector<std::string>& report() const;

 private:
  struct Impl;
  Owned<Impl> impl_;
};

}  // namespace dyn
