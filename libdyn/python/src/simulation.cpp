// SPDX-License-Identifier: BSD-2-Clause
// Simulation with controllers, forces, events and observers written in Python.
#include "module.hpp"
#include "typed.hpp"

#include <dyn/integrate/simulator.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <exception>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using Controller = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], ArrayLike]">;
using EventFunction = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], float]">;
using Observer = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], object]">;
using Statistics = Typed<py::dict, "dict[str, int]">;

/// A simulator, and the exception that a Python callback has thrown. The simulator itself says only that a callback threw.
struct Simulation {
  Simulation(const CompactModel& model, const SimulatorOptions& options) : simulator(model, options) {}
  Simulation(const ConstraintSet& constraints, const SimulatorOptions& options) : simulator(constraints, options) {}

  Simulator simulator;
  std::exception_ptr thrown;

  /// Calls `function` and throws what a callback has thrown in it, a KeyboardInterrupt too.
  template <class F>
  auto run(F&& function) {
    thrown = nullptr;
    try {
      return function();
    } catch (...) {
      if (thrown) std::rethrow_exception(thrown);
      throw;
    }
  }

  /// Calls a Python function with copies of the state; Python may keep them.
  template <class Use>
  void call(const py::function& function, double t, const VectorResult& q, const VectorResult& v, Use&& use) {
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      use(function(t, Eigen::VectorXd(q), Eigen::VectorXd(v)));
    } catch (...) {
      thrown = std::current_exception();
      throw;
    }
  }
};

SimulatorOptions optionsOf(const std::string& integrator, double dt, double tolerance, bool project, bool limits, double restitution) {
  SimulatorOptions options;
  options.integrator = integratorByName(integrator);
  options.dt = dt;
  options.tolerance = tolerance;
  options.project = project;
  options.limits = limits;
  options.restitution = restitution;
  return options;
}

/// Writes an array that a callback returned to `out`.
template <class Out>
void write(const py::object& array, const char* callback, Out&& out) {
  const auto values = py::cast<Eigen::MatrixXd>(array);
  if (values.size() != out.size())
    throw Error(ErrorCode::size,
                std::string(callback) + " returned " + std::to_string(values.size()) + " numbers, not " + std::to_string(out.size()));
  Eigen::Map<Eigen::MatrixXd>(out.data(), values.rows(), values.cols()) = values;
}

void setController(Simulation& s, const std::optional<Controller>& controller) {
  if (!controller) return s.simulator.setController(nullptr);
  s.simulator.setController([&s, f = *controller](double t, const VectorResult& q, const VectorResult& v, VectorMap tau) {
    s.call(f, t, q, v, [&](const py::object& out) { write(out, "the controller", tau); });
  });
}

void setForces(Simulation& s, const std::optional<Controller>& forces) {
  if (!forces) return s.simulator.setForces(nullptr);
  s.simulator.setForces([&s, f = *forces](double t, const VectorResult& q, const VectorResult& v, Force<double>* fext, int count) {
    s.call(f, t, q, v, [&](const py::object& out) {
      const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(out);
      if (!rows || rows.ndim() != 2 || rows.shape(0) != count || rows.shape(1) != 6)
        throw Error(ErrorCode::size, "the function of forces must return " + std::to_string(count) + " rows of 6 numbers");
      const auto x = rows.unchecked<2>();
      for (int k = 0; k < count; ++k) fext[k] = {{x(k, 0), x(k, 1), x(k, 2)}, {x(k, 3), x(k, 4), x(k, 5)}};
    });
  });
}

void setEvents(Simulation& s, const std::vector<std::tuple<std::string, EventFunction, std::string>>& events) {
  std::vector<Event> all;
  for (const auto& [name, function, direction] : events) {
    using Direction = Event::Direction;
    if (direction != "both" && direction != "rising" && direction != "falling")
      throw Error(ErrorCode::argument, "the direction of event '" + name + "' is '" + direction + "'; it must be 'both', 'rising' or 'falling'");
    all.push_back({name,
                   [&s, f = function](double t, const VectorResult& q, const VectorResult& v) {
                     double value = 0;
                     s.call(f, t, q, v, [&](const py::object& out) { value = py::cast<double>(out); });
                     return value;
                   },
                   direction == "both"     ? Direction::both
                   : direction == "rising" ? Direction::rising
                                           : Direction::falling});
  }
  s.run([&] { s.simulator.setEvents(std::move(all)); });
}

int advance(Simulation& s, double until, const std::optional<std::vector<double>>& times, const std::optional<Observer>& observer) {
  return s.run([&] {
    if (!times || !observer) return s.simulator.advance(until);
    return s.simulator.advance(until, *times,
                               [&](double t, const VectorResult& q, const VectorResult& v) { s.call(*observer, t, q, v, [](const py::object&) {}); });
  });
}

Statistics statisticsOf(const Simulation& s) {
  const SimulatorStatistics& x = s.simulator.statistics();
  using namespace py::literals;
  return py::dict("steps"_a = x.steps, "rejected"_a = x.rejected, "evaluations"_a = x.evaluations, "factorizations"_a = x.factorizations,
                  "iterations"_a = x.iterations, "impacts"_a = x.impacts, "touched"_a = x.touched, "contact_steps"_a = x.contact_steps,
                  "inexact_contacts"_a = x.inexact_contacts);
}

}  // namespace

void addSimulation(py::module_& m) {
  const py::arg_v integrator("integrator", "rk4"), dt("dt", 1e-3), tolerance("tolerance", 1e-8), project("project", true), limits("limits", false),
      restitution("restitution", 0.0);
  py::class_<Simulation> c(m, "Simulator",
                           "One simulation, for one thread.\n\n"
                           "integrator: explicit_euler, semi_implicit_euler, rk4, dormand_prince, implicit_midpoint, gauss6, radau5 or variational.\n"
                           "dt: length of a step [s]. tolerance: of adaptive integrators. project: onto constraints after each step.\n"
                           "limits: joints stop at their position limits. restitution: of impacts, in [0, 1].");
  c.def(py::init([](const CompactModel& model, const std::string& i, double h, double t, bool p, bool l, double r) {
          return std::make_unique<Simulation>(model, optionsOf(i, h, t, p, l, r));
        }),
        py::arg("model"), integrator, dt, tolerance, project, limits, restitution)
      .def(py::init([](const ConstraintSet& constraints, const std::string& i, double h, double t, bool p, bool l, double r) {
             return std::make_unique<Simulation>(constraints, optionsOf(i, h, t, p, l, r));
           }),
           py::arg("constraints"), integrator, dt, tolerance, project, limits, restitution)
      .def(
          "reset", [](Simulation& s, const Vector& q, const Vector& v, double time) { s.run([&] { s.simulator.reset(q, v, time); }); }, py::arg("q"),
          py::arg("v"), py::arg("time") = 0.0, "Sets q (nq,), v (nv,) and the time [s].")
      .def("set_controller", &setController, py::arg("controller"),
           "Sets the function controller(t, q, v) that returns tau (nv,), or None. It is called several times a step, not in the order of time.")
      .def("set_forces", &setForces, py::arg("forces"),
           "Sets the function forces(t, q, v) that returns external forces (njoints, 6), one row for each joint in its frame, or None.")
      .def("set_events", &setEvents, py::arg("events"),
           "Sets events (name, function(t, q, v), 'both' | 'rising' | 'falling'): advance() ends where a function passes zero.")
      .def(
          "set_contacts", [](Simulation& s, const ContactFinder& finder) { s.simulator.setContacts(finder); }, py::arg("finder"),
          "Sets what touches: geometry_contacts() or points_on_plane().")
      .def(
          "step", [](Simulation& s) { s.run([&] { s.simulator.step(); }); }, "Takes one step.")
      .def("advance", &advance, py::arg("until"), py::arg("times") = py::none(), py::arg("observer") = py::none(),
           "Advances to this time [s]; returns the index of the event that ended it sooner, or -1. Calls observer(t, q, v) at `times`.")
      .def_property_readonly(
          "time", [](const Simulation& s) { return s.simulator.time(); }, "The time [s].")
      .def_property_readonly(
          "q", [](const Simulation& s) { return Eigen::VectorXd(s.simulator.q()); }, "The configuration (nq,), a copy.")
      .def_property_readonly(
          "v", [](const Simulation& s) { return Eigen::VectorXd(s.simulator.v()); }, "The velocities (nv,), a copy.")
      .def_property_readonly(
          "acceleration", [](Simulation& s) { return s.run([&] { return Eigen::VectorXd(s.simulator.acceleration()); }); },
          "The accelerations (nv,) of the present state [rad/s^2, m/s^2].")
      .def_property_readonly(
          "energy", [](Simulation& s) { return s.simulator.energy(); }, "The kinetic plus the potential energy [J].")
      .def_property_readonly(
          "constraint_error", [](Simulation& s) { return s.simulator.constraintError(); }, "The largest position error [m, rad].")
      .def_property_readonly(
          "touches", [](const Simulation& s) { return s.simulator.touches(); }, "Whether something was in contact in the last step.")
      .def_property_readonly("statistics", &statisticsOf, "Numbers of steps, evaluations and so on.")
      .def(
          "save", [](const Simulation& s) { return s.simulator.save(); }, "Returns time, state and step as text, without loss.")
      .def(
          "resume", [](Simulation& s, const std::string& saved) { s.run([&] { s.simulator.resume(saved); }); }, py::arg("saved"),
          "Goes on from a saved state.");
}

}  // namespace dyn::python
