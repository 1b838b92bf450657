// SPDX-License-Identifier: BSD-2-Clause
// Contacts with friction, limits and joint friction: steps at the level of velocities, and forces within their cones. Results are new arrays.
#include "printing.hpp"

#include <dyn/constraint/friction.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using Vector3 = Eigen::Vector3d;

struct Step {
  Eigen::VectorXd v_after, impulse, velocity;
  ContactResidual residual;
  bool converged;
  int iterations;
};

struct Forces {
  Eigen::VectorXd lambda, left;
  bool converged;
  int iterations;
};

void addCones(py::module_& m) {
  py::class_<FrictionCone>(
      m, "FrictionCone",
      "Limits the force of one constraint of a set.\n\n"
      "The constraint is a contact of three rows with z along the normal (friction_contact), the lock of a joint of one degree of\n"
      "freedom, which becomes a limit, or a lock of which one coordinate becomes the joint's own friction (both_ways).")
      .def(py::init([](int constraint, double friction, double gap, bool downwards, bool both_ways, int coordinate) {
             return FrictionCone{constraint, friction, gap, downwards, both_ways, coordinate};
           }),
           py::arg("constraint"), py::arg("friction") = 0.0, py::kw_only(), py::arg("gap") = 0.0, py::arg("downwards") = false,
           py::arg("both_ways") = false, py::arg("coordinate") = 0)
      .def_readwrite("constraint", &FrictionCone::constraint, "Its number in the set.")
      .def_readwrite("friction", &FrictionCone::friction, "Coefficient; 0 for limits; for joint friction the largest force [N, N m].")
      .def_readwrite("gap", &FrictionCone::gap, "[m, rad] that contact_step may close; a negative gap is undone.")
      .def_readwrite("downwards", &FrictionCone::downwards, "An upper limit, which pushes the coordinate down.")
      .def_readwrite("both_ways", &FrictionCone::both_ways, "The friction of a joint itself.")
      .def_readwrite("coordinate", &FrictionCone::coordinate, "For joint friction: which of the joint's degrees of freedom.")
      .def("__repr__", [](const FrictionCone& c) {
        return "<cone of constraint " + std::to_string(c.constraint) + ", friction " + written(py::float_(c.friction)) + ">";
      });
  m.def(
      "friction_contact",
      [](const std::string& name, const std::string& frame, const Vector3& point, const Vector3& normal, const std::string& other) {
        return frictionContact(name, frame, fromEigen3(point), fromEigen3(normal), other);
      },
      py::arg("name"), py::arg("frame"), py::arg("point") = Vector3::Zero().eval(), py::arg("normal") = Vector3::UnitZ().eval(),
      py::arg("other") = "universe",
      "Describes a contact: `point` [m], in the axes of `frame`, touches the body of `other`, whose surface has this normal in the axes of `other`.\n"
      "Its three rows are the tangential forces and the normal force.");
}

void addResults(py::module_& m) {
  py::class_<ContactResidual>(m, "ContactResidual", "How well a step satisfies the conditions. Each force is exactly within its cone.")
      .def_readonly("penetration", &ContactResidual::penetration, "[m/s] The largest normal velocity into the other body.")
      .def_readonly("complementarity", &ContactResidual::complementarity, "[J] The largest violation of normal and dissipation conditions.");
  py::class_<Step>(m, "ContactStep", "The result of contact_step.")
      .def_readonly("v_after", &Step::v_after, "(nv,) [rad/s, m/s]")
      .def_readonly("impulse", &Step::impulse, "(rows,) [N s, N m s]")
      .def_readonly("velocity", &Step::velocity, "(rows,) after the step [m/s, rad/s]")
      .def_readonly("residual", &Step::residual, "The largest violation of a contact law [m/s].")
      .def_readonly("converged", &Step::converged, "Whether the tolerance was reached.")
      .def_readonly("iterations", &Step::iterations, "Of the solver; 0 if all contacts hold.");
  py::class_<Forces>(m, "ContactForces", "The result of contact_forces.")
      .def_readonly("forces", &Forces::lambda, "(rows,) [N, N m]")
      .def_readonly("left", &Forces::left, "(nv,) [N m, N] The generalised force that the contacts cannot explain.")
      .def_readonly("converged", &Forces::converged, "Whether the tolerance was reached.")
      .def_readonly("iterations", &Forces::iterations, "Of the solver.");
}

}  // namespace

void addFriction(py::module_& m) {
  addCones(m);
  addResults(m);
  const ContactSettings standard;
  const py::arg model("model"), data("data"), q("q"), v("v"), tau("tau"), constraints("constraints"), cones("cones");
  const py::arg_v tolerance("tolerance", standard.tolerance), most("max_iterations", standard.max_iterations);
  m.def(
      "contact_step",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& t, double dt, ConstraintData& c,
         const std::vector<FrictionCone>& k, double accuracy, int iterations, double restitution) {
        const ContactStep r = contactStep(x, d, at, w, t, dt, c, k, {accuracy, iterations, restitution});
        return Step{r.v_after, r.impulse, r.velocity, r.residual, r.converged, r.iterations};
      },
      model, data, q, v, tau, py::arg("dt"), constraints, cones, py::kw_only(), tolerance, most, py::arg("restitution") = standard.restitution,
      "Takes one step of time dt [s] at the level of velocities, with q held and forces within their cones; returns a ContactStep.\n\n"
      "cones: a FrictionCone for each constraint that it limits; other rows hold both ways. tolerance: of velocities [m/s]. max_iterations: the "
      "last\n"
      "forces are returned after that, see `converged`. restitution: of approaching velocities where the gap is closed, in [0, 1].");
  m.def(
      "contact_forces",
      [](const CompactModel& x, Data& d, const Vector& at, const Vector& w, const Vector& a, const Vector& t, ConstraintData& c,
         const std::vector<FrictionCone>& k, double accuracy, int iterations) {
        const ContactForces r = contactForces(x, d, at, w, a, t, c, k, {accuracy, iterations, 0});
        return Forces{r.lambda, r.left, r.converged, r.iterations};
      },
      model, data, q, v, py::arg("a"), tau, constraints, cones, py::kw_only(), tolerance, most,
      "Finds the forces within their cones that best explain the acceleration a under tau; returns ContactForces. tolerance: [m/s^2].");
}

}  // namespace dyn::python
