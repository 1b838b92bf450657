// SPDX-License-Identifier: BSD-2-Clause
// Constraints and the dynamics under them. Results are new arrays.
#include "arrays.hpp"
#include "choices.hpp"
#include "description.hpp"
#include "objects.hpp"

#include <dyn/constraint/batch.hpp>
#include <dyn/constraint/dynamics.hpp>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

struct Motions {
  Eigen::VectorXd motion, force;
  double residual;
  int rank, iterations;
};

std::string kindOf(const ConstraintDescription& c) {
  static constexpr const char* kinds[] = {"frames", "coupling", "lock"};
  return kinds[c.relation.index()];
}

ConstraintDescription frameConstraint(const std::string& name, const std::string& frame, const std::string& other, const SE3<double>& placement,
                                      const SE3<double>& other_placement, const std::array<bool, 6>& free, const std::string& axes, bool has_target) {
  const auto chosen_axes = chosen<ConstraintAxes>(
      "axes", axes,
      {{"LOCAL", ConstraintAxes::LOCAL}, {"OTHER", ConstraintAxes::OTHER}, {"LOCAL_WORLD_ALIGNED", ConstraintAxes::LOCAL_WORLD_ALIGNED}});
  return {name, FrameConstraint{frame, other, placement, other_placement, free, chosen_axes, has_target}};
}

/// Returns constraints of a model, or those of a set and more.
template <class Base>
ConstraintSet setOf(const Base& base, const std::optional<std::vector<ConstraintDescription>>& constraints, const JointRegistry* types) {
  return constraints ? ConstraintSet(base, *constraints, &registryOr(types)) : ConstraintSet(base);
}

Motions dynamicsOf(const CompactModel& model, Data& data, const Vector& q, const Vector& v, const Vector& tau, ConstraintData& constraints,
                   const py::object& fext, const std::string& method) {
  const auto by = chosen<ConstraintMethod>("method", method, {{"articulated", ConstraintMethod::articulated}, {"kkt", ConstraintMethod::kkt}});
  ExternalForces forces;
  if (!fext.is_none() && !readForces(fext.ptr(), "constraint_dynamics", forces)) throw py::error_already_set();
  const ConstrainedMotion r = fext.is_none() ? constraintDynamics(model, data, q, v, tau, constraints, by)
                                             : constraintDynamics(model, data, q, v, tau, constraints, forces, by);
  return {r.ddq, r.lambda, r.residual, r.rank, r.iterations};
}

void addDescriptions(py::module_& m) {
  py::class_<ConstraintDescription>(m, "ConstraintDescription", "A constraint by name: a contact, a closed loop, a coupled or a locked joint.")
      .def_readwrite("name", &ConstraintDescription::name, "The name, which errors use.")
      .def_property(
          "baumgarte", [](const ConstraintDescription& c) { return std::pair(c.baumgarte.position, c.baumgarte.velocity); },
          [](ConstraintDescription& c, const std::pair<double, double>& gains) {
            c.baumgarte = {gains.first, gains.second};
          },
          "Gains (position [1/s^2], velocity [1/s]) of the feedback that reduces violations.")
      .def_property_readonly("kind", &kindOf, "'frames', 'coupling' or 'lock'.")
      .def("__repr__", [](const ConstraintDescription& c) { return "<constraint '" + c.name + "'>"; });
  const py::arg frame("frame"), name("name"), joint("joint");
  const py::arg_v other("other", "universe");
  m.def("point_contact", &pointContact, frame, other, "Describes a point of a robot that rests on another body: three forces.");
  m.def("frame_contact", &frameContact, frame, other, "Describes a foot that stands flat or a hand that holds: three forces, three moments.");
  m.def("close_loop", &closeLoop, name, frame, py::arg("other"), py::arg("free") = std::array<bool, 6>{},
        "Describes a closed loop: frames of two bodies coincide in the directions that are not free (translations, then rotations, in axes of "
        "`other`).");
  m.def(
      "frame_constraint", &frameConstraint, name, frame, other, py::kw_only(), py::arg("placement") = SE3<double>(),
      py::arg("other_placement") = SE3<double>(), py::arg("free") = std::array<bool, 6>{}, py::arg("axes") = "LOCAL", py::arg("has_target") = false,
      "Describes any constraint between two frames.\n\n"
      "placement, other_placement: of the constraint's frames in `frame` and `other`. free: translations, then rotations, that are not constrained.\n"
      "axes: 'LOCAL', 'OTHER' or 'LOCAL_WORLD_ALIGNED', of rows, forces and free directions. has_target: the frames shall coincide, so that there "
      "is\n"
      "a position error.");
  m.def(
      "couple_joint",
      [](const std::string& dependent, const std::string& master, const std::string& type, const GivenParameters& parameters) {
        return coupleJoint(dependent, {type, master, parametersOf(parameters)});
      },
      joint, py::arg("master"), py::arg("type") = "mimic", py::arg("parameters") = GivenParameters(),
      "Describes a joint whose coordinate is a function of the master's, which a force maintains. The coordinate stays in the model.");
  m.def("lock_joint", &lockJoint, joint, py::arg("configuration") = std::vector<double>(), "Describes a joint that forces hold.");

  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def_property_readonly(
          "constraints", [](const Model& x) { return py::tuple(py::cast(x.constraints)); },
          "Of the mechanism itself: closed loops, gears. add_constraint() adds one.")
      .def(
          "add_constraint", [](Model& x, const ConstraintDescription& c) { x.constraints.push_back(c); }, py::arg("constraint"),
          "Adds a constraint of the mechanism itself.");
}

void addSets(py::module_& m) {
  const py::arg_v constraints("constraints", py::none()), types("registry", py::none());
  py::class_<ConstraintSet>(m, "ConstraintSet", "The constraints of a model, with all names resolved.")
      .def(py::init(&setOf<CompactModel>), py::arg("model"), constraints, types, "Takes these constraints, or those of the model's own description.")
      .def(py::init(&setOf<ConstraintSet>), py::arg("base"), constraints, types, "Takes the constraints of another set, followed by these.")
      .def_property_readonly("model", &ConstraintSet::model, "The model that is constrained.")
      .def_property_readonly(
          "names",
          [](const ConstraintSet& set) {
            std::vector<std::string> names;
            for (int k = 0; k < set.count(); ++k) names.push_back(set.description(k).name);
            return names;
          },
          "The names of the constraints, in the order of their rows.")
      .def("description", &ConstraintSet::description, py::arg("constraint"), py::return_value_policy::copy,
           "Returns the description of a constraint, by its number.")
      .def_property_readonly(
          "rows", [](const ConstraintSet& set) { return set.rows(); }, "The number of rows: the size of lambda.")
      .def("__len__", &ConstraintSet::count, "Returns the number of constraints.")
      .def(
          "rows_of", [](const ConstraintSet& set, int k) { return py::slice(set.firstRow(k), set.firstRow(k) + set.rows(k), 1); },
          py::arg("constraint"), "Returns the slice of the rows of one constraint.");
  py::class_<ConstraintSettings>(m, "ConstraintSettings", "How constraint forces are computed.")
      .def_readwrite("rank_tolerance", &ConstraintSettings::rank_tolerance,
                     "A row is redundant if its remaining pivot is below this fraction of its diagonal's upper bound.")
      .def_readwrite("mu", &ConstraintSettings::mu,
                     "[1/kg, 1/(kg m^2)] If positive, it is added to the diagonal of the Delassus matrix, and proximal iterations remove its effect.")
      .def_readwrite("max_iterations", &ConstraintSettings::max_iterations, "The limit of proximal iterations.")
      .def_readwrite("tolerance", &ConstraintSettings::tolerance, "[m/s^2, rad/s^2] Iterations end when all rows are within this.");
  py::class_<ConstraintData>(m, "ConstraintData", "Memory for the forces of a set of constraints, for one thread.")
      .def(py::init<const ConstraintSet&, Need>(), py::arg("constraints"), py::arg("needs") = Need::derivatives)
      .def_property_readonly("set", &ConstraintData::set, "The constraints whose forces it holds.")
      .def_readonly("settings", &ConstraintData::settings, "How forces are computed; its members may be changed between calls.")
      .def_property_readonly("nbytes", &ConstraintData::bytes, "The size in bytes.");
}

/// The forces of a batch, and whether a call is using them.
struct BatchForces {
  BatchForces(const ConstraintSet& set, const Batch<double>& batch) : data(set, batch.data) {}
  BatchConstraintData data;
  std::atomic<bool> busy = false;
};

/// Results of many states, one a row.
struct BatchMotions {
  py::object motion, force, residual, rank, iterations;
};

/// Reads the arguments, calls solve(views), which returns BatchConstrainedViews, and copies the results.
template <class Solve>
BatchMotions solveStates(const char* function, const CompactModel& model, Batch<double>& batch, BatchForces& forces,
                         const std::vector<std::pair<const char*, py::object>>& arguments, const Solve& solve) {
  StatesInput<double> states[3];
  for (std::size_t k = 0; k < arguments.size(); ++k)
    if (!states[k].read(arguments[k].second.ptr(), function, arguments[k].first)) throw py::error_already_set();
  const InUse use(batch.busy, function), use_of_forces(forces.busy, function);
  const auto found = [&] {
    const py::gil_scoped_release unlocked;
    return solve(states[0].view(), states[1].view(), states[2].view());
  }();
  const py::ssize_t count = states[0].view().cols;
  const auto rows = [&](const double* numbers, py::ssize_t size) {
    PyObject* const out = newArrayOfStates(numbers, count, size, 1);
    if (out == nullptr) throw py::error_already_set();
    return py::reinterpret_steal<py::object>(out);
  };
  return {rows(found.motion, model.nv()), rows(found.forces, forces.data.set().rows()), py::array_t<double>(count, found.residual),
          py::array_t<int>(count, found.rank), py::array_t<int>(count, found.iterations)};
}

void addBatches(py::module_& m) {
  py::class_<BatchForces>(m, "BatchConstraintData", "Memory for the forces of a set of constraints in the states of a batch.")
      .def(py::init<const ConstraintSet&, const Batch<double>&>(), py::arg("constraints"), py::arg("batch"),
           "Takes memory for calls with this batch, or with others of its model that have no more states and threads.")
      .def_property_readonly(
          "set", [](const BatchForces& x) { return x.data.set(); }, "The constraints whose forces it holds.")
      .def_property_readonly(
          "settings", [](BatchForces& x) -> ConstraintSettings& { return x.data.settings; }, py::return_value_policy::reference_internal,
          "How forces are computed; its members may be changed between calls.")
      .def_property_readonly(
          "nbytes", [](const BatchForces& x) { return x.data.bytes(); }, "The size in bytes.");
  py::class_<BatchMotions>(m, "BatchConstrainedMotion", "ConstrainedMotion in many states, one a row.")
      .def_readonly("ddq", &BatchMotions::motion, "The accelerations (states, nv) [rad/s^2, m/s^2], of constraint_dynamics.")
      .def_readonly("v_after", &BatchMotions::motion, "The velocities after the impact (states, nv) [rad/s, m/s], of impulse_dynamics.")
      .def_readonly("forces", &BatchMotions::force, "Forces (states, rows) [N, N m] on the constraints' frames.")
      .def_readonly("impulses", &BatchMotions::force, "Impulses (states, rows) [N s, N m s], of impulse_dynamics.")
      .def_readonly("residual", &BatchMotions::residual, "The largest violation of a row (states,) [m/s^2, rad/s^2; m/s, rad/s of impulse_dynamics].")
      .def_readonly("rank", &BatchMotions::rank, "The rank of the rows (states,).")
      .def_readonly("iterations", &BatchMotions::iterations, "The number of iterations of the solver (states,).");
  const py::arg model("model"), batch("data"), q("q"), v("v"), constraints("constraints");
  m.def(
      "constraint_dynamics",
      [](const CompactModel& x, Batch<double>& b, const py::object& at, const py::object& along, const py::object& tau, BatchForces& c) {
        return solveStates("constraint_dynamics", x, b, c, {{"q", at}, {"v", along}, {"tau", tau}},
                           [&](auto Q, auto V, auto Tau) { return detail::batchConstraintDynamics(x, b.data, Q, V, Tau, c.data); });
      },
      model, batch, q, v, py::arg("tau"), constraints,
      "Computes accelerations and constraint forces in every state; returns a BatchConstrainedMotion.");
  m.def(
      "impulse_dynamics",
      [](const CompactModel& x, Batch<double>& b, const py::object& at, const py::object& along, double restitution, BatchForces& c) {
        return solveStates("impulse_dynamics", x, b, c, {{"q", at}, {"v", along}},
                           [&](auto Q, auto V, auto) { return detail::batchImpulseDynamics(x, b.data, Q, V, restitution, c.data); });
      },
      model, batch, q, v, py::arg("restitution"), constraints, "Computes velocities after impacts in every state, and their impulses.");
}

}  // namespace

void addConstraints(py::module_& m) {
  addDescriptions(m);
  addSets(m);
  py::class_<Motions>(m, "ConstrainedMotion", "Accelerations (or velocities after an impact) and forces (or impulses) of the rows.")
      .def_readonly("ddq", &Motions::motion, "The accelerations (nv,) [rad/s^2, m/s^2], of constraint_dynamics.")
      .def_readonly("v_after", &Motions::motion, "The velocities after the impact (nv,) [rad/s, m/s], of impulse_dynamics.")
      .def_readonly("forces", &Motions::force, "Forces (rows,) [N, N m] that the world, or the other body, exerts on the constraint's frame.")
      .def_readonly("impulses", &Motions::force, "Impulses (rows,) [N s, N m s], of impulse_dynamics.")
      .def_readonly("residual", &Motions::residual, "The largest violation of a row [m/s^2, rad/s^2; m/s, rad/s of impulse_dynamics].")
      .def_readonly("rank", &Motions::rank, "The rank of the rows; less than their number if some are redundant.")
      .def_readonly("iterations", &Motions::iterations, "The number of iterations of the solver; 0 of impulse_dynamics.");
  const py::arg model("model"), data("data"), q("q"), v("v"), constraints("constraints");
  m.def("constraint_dynamics", &dynamicsOf, model, data, q, v, py::arg("tau"), constraints, py::kw_only(), py::arg("fext") = py::none(),
        py::arg("method") = "articulated",
        "Computes accelerations and constraint forces under tau; returns a ConstrainedMotion.\n\n"
        "fext: external forces (njoints, 6), a row (force, moment) for each joint in its frame. method: 'articulated', or 'kkt' with factors of M.");
  m.def(
      "impulse_dynamics",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, double restitution, ConstraintData& c) {
        const ConstrainedImpact r = impulseDynamics(x, d, at, w, restitution, c);
        return Motions{r.v_after, r.impulse, r.residual, r.rank, 0};
      },
      model, data, q, v, py::arg("restitution"), constraints,
      "Computes velocities after an impact (nv,), and its impulses (rows,); restitution is in [0, 1].");
  m.def(
      "compute_constraint_motion",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, ConstraintData& c) {
        const ConstraintMotion r = computeConstraintMotion(x, d, at, w, c);
        return std::make_tuple(Eigen::VectorXd(r.velocity), Eigen::VectorXd(r.bias), Eigen::VectorXd(r.error));
      },
      model, data, q, v, constraints, "Returns velocity [m/s, rad/s], bias [m/s^2, rad/s^2] and position error [m, rad] of the rows, each (rows,).");
  m.def(
      "compute_constraint_jacobian",
      [](const CompactModel& x, Data& d, const Vector& at, ConstraintData& c) { return Eigen::MatrixXd(computeConstraintJacobian(x, d, at, c)); },
      model, data, q, constraints, "Returns the Jacobian of the rows (rows, nv).");
  addBatches(m);
}

}  // namespace dyn::python
