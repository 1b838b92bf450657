// SPDX-License-Identifier: BSD-2-Clause
// Simulation of a scene island by island.
#include "description.hpp"
#include "simulation.hpp"

#include <dyn/integrate/islands.hpp>

#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>

namespace dyn::python {

namespace {

/// A scene, and its islands as simulators of Python.
class Islands {
 public:
  Islands(const Model& model, const JointRegistry& types, const CompileOptions& options, const SimulatorOptions& simulation,
          const SleepOptions& sleep)
      : scene(model, types, options, simulation, sleep), sleep_(sleep) {
    for (int k = 0; k < scene.count(); ++k) simulations_.push_back(std::make_unique<Simulation>(scene.island(k)));
  }

  Simulation& island(int k) {
    scene.island(k);  // checks the number
    return *simulations_[static_cast<std::size_t>(k)];
  }
  void wake(int k) {
    island(k).get();  // throws if another thread advances it
    scene.wake(k);
  }
  /// Does the same as scene.advance(until), but Ctrl-C ends it.
  void advance(double until) {
    if (!std::isfinite(until) || until < scene.time()) scene.advance(until);  // throws
    while (true) {
      runPython([] {});
      const double next = sleep_.allowed ? std::min(until, scene.time() + 0.1 * sleep_.time) : until;
      for (int k = 0; k < scene.count(); ++k) {
        Simulation& simulation = *simulations_[static_cast<std::size_t>(k)];
        while (!scene.asleep(k) && simulation.get().time() < next) simulation.advance(next, {}, nullptr);
      }
      // All islands are there, so this only advances the scene's own time and examines who sleeps.
      scene.advance(next);
      if (!(scene.time() < until)) return;
    }
  }

  IslandSimulator scene;

 private:
  SleepOptions sleep_;
  std::vector<std::unique_ptr<Simulation>> simulations_;
};

}  // namespace

void addIslands(py::module_& m) {
  const SleepOptions awake;
  const SimulatorOptions standard;
  m.def("islands_of", &islandsOf, py::arg("model"), py::arg("touching") = std::vector<std::string>(),
        "Returns the islands of a description: groups of trees on the world that move independently, each named by its first body.\n"
        "touching: bodies or frames that may touch each other, which ties their trees together.");
  m.def(
      "keep_for_scene",
      [](const Model& model, const std::vector<std::string>& outputs, const std::vector<std::string>& touching, bool dynamics) {
        std::vector<std::string> report;
        Model kept = keepForScene(model, {outputs, touching, dynamics}, report);
        return std::pair(std::move(kept), std::move(report));
      },
      py::arg("model"), py::arg("outputs"), py::arg("touching") = std::vector<std::string>(), py::arg("dynamics") = true,
      "Returns the model without the parts that cannot influence the outputs, and lines that say what was left out.");
  py::class_<Islands>(
      m, "IslandSimulator",
      "Simulates a scene of mechanisms that do not touch each other, each alone, and not at all while it is at rest.\n\n"
      "outputs, touching: as in a scene; only islands with an output are simulated. lock, registry: as in compile().\n"
      "integrator ... restitution: as in Simulator. sleep: whether islands may fall asleep, which they do when no joint is faster than\n"
      "sleep_speed [rad/s, m/s] for sleep_time [s].")
      .def(py::init([](const Model& model, const std::vector<std::string>& outputs, const std::vector<std::string>& touching, const Locks& lock,
                       const JointRegistry* types, const std::string& integrator, double dt, double tolerance, bool project, bool limits,
                       double restitution, bool sleep, double sleep_speed, double sleep_time) {
             CompileOptions options;
             options.lock = lockedJoints(lock);
             options.scene.outputs = outputs;
             options.scene.touching = touching;
             return std::make_unique<Islands>(model, registryOr(types), options,
                                              simulatorOptions(integrator, dt, tolerance, project, limits, restitution),
                                              SleepOptions{sleep, sleep_speed, sleep_time});
           }),
           py::arg("model"), py::kw_only(), py::arg("outputs") = std::vector<std::string>(), py::arg("touching") = std::vector<std::string>(),
           py::arg("lock") = Locks(), py::arg("registry") = py::none(), py::arg("integrator") = infoOf(standard.integrator).name,
           py::arg("dt") = standard.dt, py::arg("tolerance") = standard.tolerance, py::arg("project") = standard.project,
           py::arg("limits") = standard.limits, py::arg("restitution") = standard.restitution, py::arg("sleep") = awake.allowed,
           py::arg("sleep_speed") = awake.speed, py::arg("sleep_time") = awake.time)
      .def("__len__", [](const Islands& x) { return x.scene.count(); })
      .def("island", &Islands::island, py::arg("k"), py::return_value_policy::reference_internal,
           "Returns the Simulator of an island. Changing it does not wake the island.")
      .def(
          "island_of", [](const Islands& x, const std::string& name) { return x.scene.islandOf(name); }, py::arg("name"),
          "Returns the number of the island that has this joint, body or frame; -1 if none has it.")
      .def(
          "asleep", [](const Islands& x, int k) { return x.scene.asleep(k); }, py::arg("k"), "Returns whether an island sleeps.")
      .def("wake", &Islands::wake, py::arg("k"), "Lets an island move again, for example after a new controller.")
      .def(
          "advance", [](Islands& x, double until) { withPythonExceptions([&] { x.advance(until); }); }, py::arg("until"),
          "Advances all islands to this time [s], one after the other. Their events do not end it.")
      .def_property_readonly(
          "time", [](const Islands& x) { return x.scene.time(); }, "The time [s] that all islands have reached.")
      .def_property_readonly(
          "report", [](const Islands& x) { return x.scene.report(); }, "What was left out, and how many islands there are.");
}

}  // namespace dyn::python
