// SPDX-License-Identifier: BSD-2-Clause
// A simulator as Python uses it.
#pragma once

#include "callbacks.hpp"

#include <dyn/integrate/simulator.hpp>

#include <memory>
#include <stdexcept>
#include <thread>

namespace dyn::python {

/// The options of a simulator as Python's constructors have them.
SimulatorOptions simulatorOptions(const std::string& integrator, double dt, double tolerance, bool project, bool limits, double restitution);

/// A simulator of its own, or one of an IslandSimulator that outlives this object. All calls hold the interpreter's lock when they begin.
class Simulation {
 public:
  template <class Source>
  Simulation(const Source& source, const SimulatorOptions& options) : own_(std::make_unique<Simulator>(source, options)), simulator_(own_.get()) {}
  explicit Simulation(Simulator& other) : simulator_(&other) {}

  /// Returns the simulator. Throws a RuntimeError while another thread advances it.
  Simulator& get() const {
    if (running_ && thread_ != std::this_thread::get_id()) throw std::runtime_error("Simulator: another thread is advancing this simulator");
    return *simulator_;
  }
  /// Returns simulator.advance(until, times, observer). Ctrl-C ends it. The interpreter's lock is free meanwhile if no callback is written in Python.
  int advance(double until, const std::vector<double>& times, const Observer& observer);

  bool python_controller = false, python_forces = false, python_events = false;  ///< which callbacks are written in Python

 private:
  int advanceUnlocked(double until, const std::vector<double>& times, const Observer& observer);

  std::unique_ptr<Simulator> own_;
  Simulator* simulator_;
  bool running_ = false;
  std::thread::id thread_;
};

}  // namespace dyn::python
