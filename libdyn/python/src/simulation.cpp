// SPDX-License-Identifier: BSD-2-Clause
// Simulation with controllers, forces, events and observers written in Python.
#include "simulation.hpp"

#include "choices.hpp"
#include "typed.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using ControllerFunction = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], ArrayLike]">;
using EventFunction = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], float]">;
using ObserverFunction = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], object]">;
using DerivativesFunction = Typed<py::function, "Callable[[float, NDArray[float64], NDArray[float64]], tuple[ArrayLike, ArrayLike]]">;
using Statistics = Typed<py::dict, "dict[str, int]">;

/// Returns the times at which advance() looks whether the user has interrupted it: not more often than every 256 steps, and not too many.
std::vector<double> interruptible(double from, double until, double dt) {
  const double steps = (until - from) / dt;
  if (!(steps > 256)) return {};
  const auto count = static_cast<std::size_t>(std::min(steps / 256, 65536.0));
  std::vector<double> times(count);
  for (std::size_t k = 0; k < count; ++k) times[k] = from + (until - from) * static_cast<double>(k + 1) / static_cast<double>(count + 1);
  return times;
}

void setController(Simulation& s, const std::optional<ControllerFunction>& controller, const std::optional<DerivativesFunction>& derivatives) {
  if (derivatives && !controller) throw Error(ErrorCode::argument, "set_controller: derivatives without a controller");
  Controller control;
  ControllerDerivatives differentiate;
  if (controller)
    control = [f = *controller](double t, const VectorResult& q, const VectorResult& v, VectorMap tau) {
      callPython(f, t, q, v, [&](const py::object& out) { writeReturned(out, "the controller", tau); });
    };
  if (derivatives)
    differentiate = [f = *derivatives](double t, const VectorResult& q, const VectorResult& v, MatrixMap dtau_dq, MatrixMap dtau_dv) {
      callPython(f, t, q, v, [&](const py::object& out) {
        const auto [by_q, by_v] = returned<std::pair<py::object, py::object>>(out, "the derivatives of the controller", "two arrays of numbers");
        writeReturned(by_q, "the derivatives of the controller", dtau_dq);
        writeReturned(by_v, "the derivatives of the controller", dtau_dv);
      });
    };
  s.get().setController(std::move(control), std::move(differentiate));
  s.python_controller = controller.has_value();
}

void setForces(Simulation& s, const std::optional<ControllerFunction>& forces) {
  Forces act;
  if (forces)
    act = [f = *forces](double t, const VectorResult& q, const VectorResult& v, Force<double>* fext, int count) {
      callPython(f, t, q, v, [&](const py::object& out) {
        const auto rows = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(out);
        if (!rows || rows.ndim() != 2 || rows.shape(0) != count || rows.shape(1) != 6)
          throw Error(ErrorCode::size, "the function of forces must return " + std::to_string(count) + " rows of 6 numbers");
        const auto x = rows.unchecked<2>();
        for (int k = 0; k < count; ++k) fext[k] = {{x(k, 0), x(k, 1), x(k, 2)}, {x(k, 3), x(k, 4), x(k, 5)}};
      });
    };
  s.get().setForces(std::move(act));
  s.python_forces = forces.has_value();
}

void setEvents(Simulation& s, const std::vector<std::tuple<std::string, EventFunction, std::string>>& events) {
  std::vector<Event> all;
  for (const auto& [name, function, direction] : events) {
    using Direction = Event::Direction;
    const auto kind = chosen<Direction>(("the direction of event '" + name + "'").c_str(), direction,
                                        {{"both", Direction::both}, {"rising", Direction::rising}, {"falling", Direction::falling}});
    all.push_back({name,
                   [f = function](double t, const VectorResult& q, const VectorResult& v) {
                     double value = 0;
                     callPython(f, t, q, v, [&](const py::object& out) { value = returned<double>(out, "the function of an event", "a number"); });
                     return value;
                   },
                   kind});
  }
  withPythonExceptions([&] { s.get().setEvents(std::move(all)); });
  s.python_events = !events.empty();
}

int advance(Simulation& s, double until, const std::optional<std::vector<double>>& times, const std::optional<ObserverFunction>& observer) {
  Observer observe;
  if (times.has_value() != observer.has_value()) throw Error(ErrorCode::argument, "advance: give both times and an observer, or none of them");
  if (observer) observe = [&](double t, const VectorResult& q, const VectorResult& v) { callPython(*observer, t, q, v, [](const py::object&) {}); };
  return withPythonExceptions([&] { return s.advance(until, times.value_or(std::vector<double>()), observe); });
}

Statistics statisticsOf(const Simulation& s) {
  const SimulatorStatistics& x = s.get().statistics();
  using namespace py::literals;
  return py::dict("steps"_a = x.steps, "rejected"_a = x.rejected, "evaluations"_a = x.evaluations, "factorizations"_a = x.factorizations,
                  "iterations"_a = x.iterations, "impacts"_a = x.impacts, "touched"_a = x.touched, "contact_steps"_a = x.contact_steps,
                  "inexact_contacts"_a = x.inexact_contacts);
}

}  // namespace

SimulatorOptions simulatorOptions(const std::string& integrator, double dt, double tolerance, bool project, bool limits, double restitution) {
  return {integratorByName(integrator), dt, tolerance, project, limits, restitution};
}

int Simulation::advance(double until, const std::vector<double>& times, const Observer& observer) {
  Simulator& simulator = get();
  // States at further times are read to look for Ctrl-C. They change no step.
  const double now = simulator.time();
  const bool valid = times.empty() || (std::is_sorted(times.begin(), times.end()) && times.front() >= now && times.back() <= until);
  std::vector<double> all = valid ? interruptible(now, until, simulator.options().dt) : std::vector<double>();
  const std::size_t looks = all.size();
  all.insert(all.end(), times.begin(), times.end());
  std::inplace_merge(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(looks), all.end());
  std::size_t shown = 0;
  const auto observe = [&](double t, const VectorResult& q, const VectorResult& v) {
    if (shown < times.size() && t == times[shown]) {
      ++shown;
      observer(t, q, v);
    } else {
      runPython([] {});
    }
  };
  if (python_controller || python_forces || python_events) return simulator.advance(until, all, observe);
  struct Running {
    Simulation& simulation;
    bool outermost;
    explicit Running(Simulation& s) : simulation(s), outermost(!s.running_) {
      s.running_ = true;
      s.thread_ = std::this_thread::get_id();
    }
    ~Running() { simulation.running_ = !outermost; }
  } running(*this);
  const py::gil_scoped_release unlocked;
  return simulator.advance(until, all, observe);
}

void addSimulation(py::module_& m) {
  py::class_<IntegratorInfo>(m, "IntegratorInfo", "The properties of an integrator.")
      .def_readonly("name", &IntegratorInfo::name, "The name by which simulators are given it.")
      .def_readonly("order", &IntegratorInfo::order, "The order of the global error in the step size.")
      .def_readonly("adaptive", &IntegratorInfo::adaptive, "Whether the step size follows a tolerance.")
      .def_readonly("implicit", &IntegratorInfo::implicit, "Whether every step solves equations.")
      .def("__repr__", [](const IntegratorInfo& x) { return std::string("<integrator '") + x.name + "'>"; });
  m.def("integrators", &integrators, "Returns the properties of all integrators.");
  const py::arg_v integrator("integrator", "rk4"), dt("dt", 1e-3), tolerance("tolerance", 1e-8), project("project", true), limits("limits", false),
      restitution("restitution", 0.0);
  py::class_<Simulation> c(m, "Simulator",
                           "One simulation, for one thread.\n\n"
                           "integrator: explicit_euler, semi_implicit_euler, rk4, dormand_prince, implicit_midpoint, gauss6, radau5 or variational.\n"
                           "dt: length of a step [s]. tolerance: of adaptive integrators. project: onto constraints after each step.\n"
                           "limits: joints stop at their position limits. restitution: of impacts, in [0, 1].");
  c.def(py::init([](const CompactModel& model, const std::string& i, double h, double t, bool p, bool l, double r) {
          return std::make_unique<Simulation>(model, simulatorOptions(i, h, t, p, l, r));
        }),
        py::arg("model"), integrator, dt, tolerance, project, limits, restitution)
      .def(py::init([](const ConstraintSet& constraints, const std::string& i, double h, double t, bool p, bool l, double r) {
             return std::make_unique<Simulation>(constraints, simulatorOptions(i, h, t, p, l, r));
           }),
           py::arg("constraints"), integrator, dt, tolerance, project, limits, restitution)
      .def(
          "reset", [](Simulation& s, const Vector& q, const Vector& v, double time) { withPythonExceptions([&] { s.get().reset(q, v, time); }); },
          py::arg("q"), py::arg("v"), py::arg("time") = 0.0, "Sets state and time.")
      .def("set_controller", &setController, py::arg("controller"), py::arg("derivatives") = py::none(),
           "Sets the function controller(t, q, v) that returns tau (nv,), or None. It is called several times a step, not in the order of time.\n\n"
           "derivatives(t, q, v) returns d tau / d q (in the tangent space) and d tau / d v, (nv, nv) each. It makes implicit integrators faster.")
      .def("set_forces", &setForces, py::arg("forces"),
           "Sets the function forces(t, q, v) that returns external forces (njoints, 6), one row for each joint in its frame, or None.")
      .def("set_events", &setEvents, py::arg("events"),
           "Sets events (name, function(t, q, v), 'both' | 'rising' | 'falling'): advance() ends where a function passes zero.")
      .def(
          "set_contacts", [](Simulation& s, const ContactFinder& finder) { s.get().setContacts(finder); }, py::arg("finder"),
          "Sets what touches: geometry_contacts() or points_on_plane().")
      .def(
          "step", [](Simulation& s) { withPythonExceptions([&] { s.get().step(); }); }, "Takes one step.")
      .def("advance", &advance, py::arg("until"), py::arg("times") = py::none(), py::arg("observer") = py::none(),
           "Advances to this time [s]; returns the index of the event that ended it sooner, or -1. Calls observer(t, q, v) at `times`.")
      .def_property_readonly(
          "model", [](const Simulation& s) { return s.get().model(); }, "The model that is simulated.")
      .def_property_readonly(
          "dt", [](const Simulation& s) { return s.get().options().dt; }, "The length of a step [s].")
      .def_property_readonly(
          "integrator", [](const Simulation& s) { return infoOf(s.get().options().integrator).name; }, "Its name.")
      .def_property_readonly(
          "time", [](const Simulation& s) { return s.get().time(); }, "The time [s].")
      .def_property_readonly(
          "q", [](const Simulation& s) { return Eigen::VectorXd(s.get().q()); }, "The configuration (nq,), a copy.")
      .def_property_readonly(
          "v", [](const Simulation& s) { return Eigen::VectorXd(s.get().v()); }, "The velocities (nv,), a copy.")
      .def_property_readonly(
          "acceleration", [](Simulation& s) { return withPythonExceptions([&] { return Eigen::VectorXd(s.get().acceleration()); }); },
          "The accelerations (nv,) of the present state [rad/s^2, m/s^2].")
      .def_property_readonly(
          "energy", [](Simulation& s) { return s.get().energy(); }, "Kinetic plus potential [J].")
      .def_property_readonly(
          "constraint_error", [](Simulation& s) { return s.get().constraintError(); }, "The largest position error [m, rad].")
      .def_property_readonly(
          "touches", [](const Simulation& s) { return s.get().touches(); }, "Whether something was in contact in the last step.")
      .def_property_readonly("statistics", &statisticsOf, "Numbers of steps, evaluations and so on.")
      .def(
          "save", [](const Simulation& s) { return s.get().save(); }, "Returns time, state and step as text, without loss.")
      .def(
          "resume", [](Simulation& s, const std::string& saved) { withPythonExceptions([&] { s.get().resume(saved); }); }, py::arg("saved"),
          "Goes on from a saved state.");
}

}  // namespace dyn::python
