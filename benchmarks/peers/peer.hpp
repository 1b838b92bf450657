// SPDX-License-Identifier: BSD-2-Clause
// Other libraries behind one small interface, so that one program can time them in turn.
#pragma once

#include "peers/robot.hpp"

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace dyn::benchmark::peers {

enum class Task { rnea, crba, aba, minverse, rnea_derivatives, aba_derivatives };
constexpr Task tasks[] = {Task::rnea, Task::crba, Task::aba, Task::minverse, Task::rnea_derivatives, Task::aba_derivatives};
const char* nameOf(Task task);
/// The basic tasks: forces, mass matrix and accelerations.
constexpr bool isBasic(Task task) { return task <= Task::aba; }
constexpr bool isMatrix(Task task) { return task != Task::rnea && task != Task::aba; }

/// One robot in one library. run() does all work of a task, from q to the result, as users of that library write it.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual bool can(Task task) const = 0;
  virtual void run(Task task, const State& state) = 0;
  /// Returns the result of the last run for the joints without the floating base, in the order of Robot: forces (rnea), accelerations (aba), or a
  /// matrix row by row: the mass matrix (crba), its inverse (minverse), or the derivative by q (rnea_derivatives, aba_derivatives).
  virtual std::vector<double> result(Task task) const = 0;

  /// Names of the library's own integrators with a fixed step, for robots without floating base; empty if the library has none.
  virtual std::vector<std::string> integrators() const { return {}; }
  /// Simulates with one of integrators(), from rest at q and without torques. Returns the joints' coordinates after `time` [s] in `steps` steps.
  virtual std::vector<double> move(const std::string&, const std::vector<double>&, double /*time*/, int /*steps*/) {
    throw std::logic_error("a library without integrators was asked to move");
  }
};

struct Library {
  std::string name, version;
  std::string build;        ///< compiler, and the processors that the code is compiled for
  bool for_this_processor;  ///< false: the library would be faster if it were compiled for the processor at hand
  /// Returns null if the library cannot represent the robot. May throw std::exception.
  std::function<std::unique_ptr<Peer>(const Robot& robot)> make;
};

}  // namespace dyn::benchmark::peers
