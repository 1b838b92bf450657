// SPDX-License-Identifier: BSD-2-Clause
// Simulation of many trajectories of one model in threads.
#include "choices.hpp"
#include "objects.hpp"
#include "simulation.hpp"

#include <dyn/data/data_pool.hpp>
#include <dyn/integrate/batch_stepper.hpp>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <optional>

namespace dyn::python {

namespace {

using Array = py::array_t<double, py::array::c_style>;

std::string shapeOf(const std::vector<py::ssize_t>& sizes) {
  std::string out = "(";
  for (std::size_t k = 0; k < sizes.size(); ++k) out += (k ? ", " : "") + std::to_string(sizes[k]);
  return out + (sizes.size() == 1 ? ",)" : ")");
}

/// Reads an array of numbers. Throws TypeError for anything else.
Array numbersOf(const py::object& object, const char* name) {
  Array out = object.is_none() ? Array() : Array::ensure(object);
  if (out && !object.is_none()) return out;
  const std::string given = py::isinstance<py::array>(object) ? "an array of dtype " + py::str(object.attr("dtype")).cast<std::string>()
                                                              : py::repr(py::type::of(object)).cast<std::string>();
  throw py::type_error(std::string("rollout: ") + name + " must be an array of numbers, not " + given);
}

[[noreturn]] void refuse(const char* name, const Array& x, const std::string& wanted) {
  throw Error(ErrorCode::size, std::string("rollout: ") + name + " has the shape " +
                                   shapeOf(std::vector<py::ssize_t>(x.shape(), x.shape() + x.ndim())) + "; it must be " + wanted);
}

/// The first states of trajectories: one for all, or one each.
struct Starts {
  const double* first;
  py::ssize_t step;
  int size;
  Starts(const Array& x, const char* name, py::ssize_t trajectories, int n) : first(x.data()), step(x.ndim() == 2 ? n : 0), size(n) {
    const bool fits = (x.ndim() == 1 && x.shape(0) == size) || (x.ndim() == 2 && x.shape(0) == trajectories && x.shape(1) == size);
    if (!fits) refuse(name, x, shapeOf({size}) + " or " + shapeOf({trajectories, size}));
  }
  VectorArg operator[](std::ptrdiff_t k) const { return {first + k * step, size}; }
};

/// Returns a simulator for each thread.
template <class Source>
std::vector<Simulator> simulatorsFor(const Source& source, const SimulatorOptions& options, int threads,
                                     const std::optional<py::function>& contacts) {
  std::vector<Simulator> out;
  std::vector<py::object> finders;
  for (int k = 0; k < threads; ++k) {
    out.emplace_back(source, options);
    if (!contacts) continue;
    const py::object& finder = finders.emplace_back((*contacts)());
    if (!py::isinstance<ContactFinder>(finder)) throw py::type_error("rollout: contacts must make a ContactFinder");
    for (std::size_t i = 0; i + 1 < finders.size(); ++i)
      if (finder.is(finders[i]))
        throw Error(ErrorCode::argument, "rollout: contacts must make a new finder in each call, since threads cannot share one");
    out.back().setContacts(py::cast<ContactFinder>(finder));
  }
  return out;
}

/// Sets constant joint forces. Integrators that remember an evaluation of the last step forget it, since the controller is a new one.
void control(Simulator& simulator, const double* tau) {
  simulator.setController([tau](double, const VectorResult&, const VectorResult&, VectorMap out) { std::copy_n(tau, out.size(), out.data()); },
                          [](double, const VectorResult&, const VectorResult&, const MatrixMap&, const MatrixMap&) {});
}

/// Lets a user interrupt work in threads. The caller's thread answers Ctrl-C, and all stop.
class Interruptible {
 public:
  /// Returns whether to go on. Throws KeyboardInterrupt in the caller's thread, which is number 0.
  bool goesOn(int thread) {
    if (thread == 0 && !stopped_) {
      try {
        runPython([] {});
      } catch (...) {
        stopped_ = true;
        throw;
      }
    }
    return !stopped_;
  }

 private:
  std::atomic<bool> stopped_ = false;
};

struct Options {
  SimulatorOptions simulator;
  int threads;
  std::optional<py::function> contacts;
  bool nan_where_diverged;
};

template <class Source>
py::tuple rollout(const Source& source, const CompactModel& model, const py::object& q0, const py::object& v0, const py::object& controls,
                  const Options& options) {
  const Array forces = numbersOf(controls, "controls"), first_q = numbersOf(q0, "q0"), first_v = numbersOf(v0, "v0");
  const int nq = model.nq(), nv = model.nv();
  if (forces.ndim() != 3 || forces.shape(2) != nv) refuse("controls", forces, "(trajectories, steps, " + std::to_string(nv) + ")");
  const py::ssize_t trajectories = forces.shape(0), steps = forces.shape(1);
  const Starts qs(first_q, "q0", trajectories, nq), vs(first_v, "v0", trajectories, nv);
  py::array_t<double> q({trajectories, steps + 1, py::ssize_t{nq}}), v({trajectories, steps + 1, py::ssize_t{nv}});
  double *const all_q = q.mutable_data(), *const all_v = v.mutable_data();
  const double* const all_tau = forces.data();

  DataPool pool(model, Need::state, options.threads);
  std::vector<Simulator> simulators = simulatorsFor(source, options.simulator, options.threads, options.contacts);
  Interruptible work;
  const auto simulate = [&](std::ptrdiff_t k, int thread) {
    Simulator& simulator = simulators[static_cast<std::size_t>(thread)];
    double *to_q = all_q + k * (steps + 1) * nq, *to_v = all_v + k * (steps + 1) * nv;
    const auto write = [&] {
      to_q = std::copy_n(simulator.q().data(), nq, to_q);
      to_v = std::copy_n(simulator.v().data(), nv, to_v);
    };
    simulator.reset(qs[k], vs[k]);
    write();
    try {
      for (py::ssize_t i = 0; i < steps; ++i) {
        if (i % 256 == 0 && !work.goesOn(thread)) return;
        control(simulator, all_tau + (k * steps + i) * nv);
        simulator.advance(static_cast<double>(i + 1) * options.simulator.dt);
        write();
      }
    } catch (const Error& e) {
      if (!options.nan_where_diverged || e.code() != ErrorCode::simulation || thrownHere()) throw;
      constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
      std::fill(to_q, all_q + (k + 1) * (steps + 1) * nq, unknown);
      std::fill(to_v, all_v + (k + 1) * (steps + 1) * nv, unknown);
    }
  };
  {
    const py::gil_scoped_release unlocked;
    pool.forEach(trajectories, [&](Data&, std::ptrdiff_t k, int thread) { withPythonExceptions([&] { simulate(k, thread); }); });
  }
  return py::make_tuple(q, v);
}

/// A BatchStepper of Python, and whether a call is using it.
struct Stepper {
  Stepper(const CompactModel& of, int capacity, const std::string& method, int threads)
      : model(of), stepper(of, capacity, integratorByName(method), threads) {}

  py::tuple rollout(double dt, const py::object& q0, const py::object& v0, const py::object& controls) {
    const Array forces = numbersOf(controls, "controls"), first_q = numbersOf(q0, "q0"), first_v = numbersOf(v0, "v0");
    const py::ssize_t nq = model.nq(), nv = model.nv();
    if (forces.ndim() != 3 || forces.shape(2) != nv) refuse("controls", forces, "(steps, states, " + std::to_string(nv) + ")");
    const py::ssize_t steps = forces.shape(0), states = forces.shape(1);
    const auto view = [&](const Array& x, const char* name, py::ssize_t size) -> detail::StatesView<double> {
      if (x.ndim() != 2 || x.shape(0) != states || x.shape(1) != size) refuse(name, x, shapeOf({states, size}));
      return {x.data(), size, states, size, true};
    };
    const auto q = view(first_q, "q0", nq), v = view(first_v, "v0", nv);
    py::array_t<double> all_q({steps, states, nq}), all_v({steps, states, nv});
    const MatrixOut to_q(all_q.mutable_data(), nq, steps * states), to_v(all_v.mutable_data(), nv, steps * states);
    const InUse use(busy, "rollout");
    {
      const py::gil_scoped_release unlocked;
      stepper.rollout(dt, q, v, detail::StatesView<double>{forces.data(), nv, steps * states, nv, true}, to_q, to_v);
    }
    return py::make_tuple(all_q, all_v);
  }

  CompactModel model;
  BatchStepper stepper;
  std::atomic<bool> busy = false;
};

}  // namespace

void addRollout(py::module_& m) {
  py::class_<Stepper>(
      m, "BatchStepper",
      "Integrates up to `capacity` states of a model in the lanes of a batch, by explicit_euler, semi_implicit_euler or rk4, without\n"
      "contacts, constraints, limits and events; `rollout` has these.")
      .def(py::init<const CompactModel&, int, const std::string&, int>(), py::arg("model"), py::arg("capacity"), py::arg("integrator") = "rk4",
           py::arg("threads") = 1)
      .def("rollout", &Stepper::rollout, py::arg("dt"), py::arg("q0"), py::arg("v0"), py::arg("controls"),
           "Takes steps of dt [s] from one state a row under the joint forces `controls` (steps, states, nv), each held for a step; returns the\n"
           "configurations (steps, states, nq) and velocities (steps, states, nv) at the ends of the steps.");
  const SimulatorOptions standard;
  const py::arg q0("q0"), v0("v0"), controls("controls"), dt("dt");
  const py::arg_v integrator("integrator", infoOf(standard.integrator).name), threads("threads", 1), tolerance("tolerance", standard.tolerance),
      project("project", standard.project), limits("limits", standard.limits), restitution("restitution", standard.restitution),
      contacts("contacts", py::none()), diverged("diverged", "raise");
  const char* const doc =
      "Simulates many trajectories; returns the configurations (trajectories, steps + 1, nq) and velocities (trajectories, steps + 1, nv).\n\n"
      "q0, v0: the first state (nq,), (nv,) of all trajectories, or one state a row. controls: joint forces tau (trajectories, steps, nv), each "
      "held\n"
      "for dt [s], which is also the length of a step. threads: how many compute; the results are the same for any number, and the interpreter's "
      "lock\n"
      "is free meanwhile. contacts: a function without arguments that makes a ContactFinder; it is called once for each thread. diverged: 'raise', "
      "or\n"
      "'nan', which makes the rest of a trajectory nan where its simulation cannot go on. Other arguments are those of Simulator.";
  const auto add = [&]<class Source>(const Source*, const char* name, auto model_of) {
    m.def(
        "rollout",
        [model_of](const Source& source, const py::object& q, const py::object& v, const py::object& tau, double h, const std::string& by, int n,
                   double accuracy, bool projects, bool stops, double bounce, const std::optional<py::function>& touch,
                   const std::string& otherwise) {
          const bool nan = chosen<bool>("diverged", otherwise, {{"raise", false}, {"nan", true}});
          return rollout(source, model_of(source), q, v, tau, {simulatorOptions(by, h, accuracy, projects, stops, bounce), n, touch, nan});
        },
        py::arg(name), q0, v0, controls, dt, integrator, threads, py::kw_only(), tolerance, project, limits, restitution, contacts, diverged, doc);
  };
  add(static_cast<const CompactModel*>(nullptr), "model", [](const CompactModel& model) -> const CompactModel& { return model; });
  add(static_cast<const ConstraintSet*>(nullptr), "constraints", [](const ConstraintSet& set) -> const CompactModel& { return set.model(); });
}

}  // namespace dyn::python
