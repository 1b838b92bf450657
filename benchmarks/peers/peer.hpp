// Other libraries behind one small interface, so that they can be timed in one go.
#pragma once

#include "peers/robot.hpp"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace dyn::benchmark::peers {

enum class Task { rnea, crba, aba, minverse, rnea_derivatives, aba_derivatives };
constexpr Task tasks[] = {Task::rnea, Task::crba, Task::aba, Task::minverse, Task::rnea_derivatives, Task::aba_derivatives};
const char* nameOf(Task task);
/// What every library has.
constexpr bool isBasic(Task task) { return task <= Task::aba; }
constexpr bool isMatrix(Task task) { return task != Task::rnea && task != Task::aba; }

/// One robot in one library. All work of a task is done by run(), from q to the result, as its users write it.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual bool can(Task task) const = 0;
  virtual void run(Task task, const State& state) = 0;
  /// Of the last run, for the joints without the floating base, in the order of Robot: forces (rnea), accelerations (aba), matrices row by row: the
  /// mass matrix (crba), its inverse, and derivatives by q of all that derivatives give.
  virtual std::vector<double> result(Task task) const = 0;

  /// Its own methods of moving through time in equal steps; of robots that do not float, and none where it has none.
  virtual std::vector<std::string> integrators() const { return {}; }
  /// From rest at q, without torques: the joints' coordinates after `time`. Of an integrator that it has.
  virtual std::vector<double> move(const std::string&, const std::vector<double>&, double /*time*/, int /*steps*/) {
    throw std::logic_error("a library without integrators was asked to move");
  }
};

struct Library {
  std::string name, version;
  /// Null where the library cannot hold the robot. May throw std::exception.
  std::unique_ptr<Peer> (*make)(const Robot& robot);
};

/// Those that were there when this program was compiled; libdyn is the first.
std::vector<Library> libraries();

}  // namespace dyn::benchmark::peers
