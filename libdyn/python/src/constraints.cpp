// SPDX-License-Identifier: BSD-2-Clause
// Constraints and the dynamics under them. Results are new arrays.
#include "description.hpp"

#include <dyn/constraint/dynamics.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

struct Motions {
  Eigen::VectorXd motion, force;
  double residual;
  int rank, iterations;
};

}  // namespace

void addConstraints(py::module_& m) {
  py::class_<ConstraintDescription>(m, "ConstraintDescription", "A constraint by name: a contact, a closed loop, a coupled or a locked joint.")
      .def_readwrite("name", &ConstraintDescription::name, "The name, which errors use.")
      .def_property(
          "baumgarte", [](const ConstraintDescription& c) { return std::pair(c.baumgarte.position, c.baumgarte.velocity); },
          [](ConstraintDescription& c, const std::pair<double, double>& gains) {
            c.baumgarte = {gains.first, gains.second};
          },
          "Gains (position [1/s^2], velocity [1/s]) of the feedback that reduces violations.")
      .def("__repr__", [](const ConstraintDescription& c) { return "<constraint '" + c.name + "'>"; });
  const py::arg frame("frame"), name("name"), joint("joint");
  const py::arg_v other("other", "universe");
  m.def("point_contact", &pointContact, frame, other, "Describes a point of a robot that rests on another body: three forces.");
  m.def("frame_contact", &frameContact, frame, other, "Describes a foot that stands flat or a hand that holds: three forces, three moments.");
  m.def("close_loop", &closeLoop, name, frame, py::arg("other"), py::arg("free") = std::array<bool, 6>{},
        "Describes a closed loop: frames of two bodies coincide in the directions that are not free (translations, then rotations, in axes of "
        "`other`).");
  m.def("lock_joint", &lockJoint, joint, py::arg("configuration") = std::vector<double>(), "Describes a joint that forces hold.");

  py::reinterpret_borrow<py::class_<Model>>(m.attr("Model"))
      .def_readonly("constraints", &Model::constraints, "Of the mechanism itself: closed loops, gears.")
      .def(
          "add_constraint", [](Model& x, const ConstraintDescription& c) { x.constraints.push_back(c); }, py::arg("constraint"),
          "Adds a constraint of the mechanism itself.");

  py::class_<ConstraintSet>(m, "ConstraintSet", "The constraints of a model, with all names resolved.")
      .def(py::init([](const CompactModel& model, const std::optional<std::vector<ConstraintDescription>>& constraints) {
             return constraints ? ConstraintSet(model, *constraints, &registry()) : ConstraintSet(model);
           }),
           py::arg("model"), py::arg("constraints") = py::none(), "Without `constraints`, takes those of the model's own description.")
      .def_property_readonly(
          "rows", [](const ConstraintSet& set) { return set.rows(); }, "The number of rows: the size of lambda.")
      .def("__len__", &ConstraintSet::count, "Returns the number of constraints.")
      .def(
          "rows_of", [](const ConstraintSet& set, int k) { return py::slice(set.firstRow(k), set.firstRow(k) + set.rows(k), 1); },
          py::arg("constraint"), "Returns the slice of the rows of one constraint.");
  py::class_<ConstraintData>(m, "ConstraintData", "Memory for the forces of a set of constraints, for one thread.")
      .def(py::init<const ConstraintSet&, Need>(), py::arg("constraints"), py::arg("needs") = Need::derivatives)
      .def_property_readonly("set", &ConstraintData::set, "The constraints whose forces it holds.");

  py::class_<Motions>(m, "ConstrainedMotion", "Accelerations (or velocities after an impact) and forces (or impulses) of the rows.")
      .def_readonly("ddq", &Motions::motion, "The accelerations (nv,) [rad/s^2, m/s^2], of constraint_dynamics.")
      .def_readonly("v_after", &Motions::motion, "The velocities after the impact (nv,) [rad/s, m/s], of impulse_dynamics.")
      .def_readonly("forces", &Motions::force, "Forces (rows,) [N, N m] that the world, or the other body, exerts on the constraint's frame.")
      .def_readonly("impulses", &Motions::force, "Impulses (rows,) [N s, N m s], of impulse_dynamics.")
      .def_readonly("residual", &Motions::residual, "The largest violation of a row [m/s^2, rad/s^2; m/s, rad/s of impulse_dynamics].")
      .def_readonly("rank", &Motions::rank, "The rank of the rows; less than their number if some are redundant.")
      .def_readonly("iterations", &Motions::iterations, "The number of iterations of the solver; 0 of impulse_dynamics.");
  const py::arg model("model"), data("data"), q("q"), v("v"), constraints("constraints");
  m.def(
      "constraint_dynamics",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& tau, ConstraintData& c) {
        const ConstrainedMotion r = constraintDynamics(x, d, at, w, tau, c);
        return Motions{r.ddq, r.lambda, r.residual, r.rank, r.iterations};
      },
      model, data, q, v, py::arg("tau"), constraints, "Computes accelerations (nv,) and constraint forces (rows,) under tau (nv,) [N m, N].");
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
}

}  // namespace dyn::python
