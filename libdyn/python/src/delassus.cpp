// SPDX-License-Identifier: BSD-2-Clause
// The Delassus matrix, and projection of states onto constraints. Results are new arrays.
#include "module.hpp"

#include <dyn/constraint/assembly.hpp>
#include <dyn/constraint/delassus.hpp>
#include <dyn/error.hpp>

#include <pybind11/eigen.h>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;

struct Assembled {
  Eigen::VectorXd q;
  double error;
  bool closed;
  int iterations;
};

Eigen::VectorXd applied(const DelassusOperator& op, const Vector& x) {
  Eigen::VectorXd out(x.size());
  op.apply(x, out);
  return out;
}

}  // namespace

void addDelassus(py::module_& m) {
  const py::arg model("model"), data("data"), q("q"), v("v"), constraints("constraints"), x("x");
  m.def(
      "compute_delassus_matrix",
      [](const CompactModel& k, Data& d, const Vector& at, ConstraintData& c) { return Eigen::MatrixXd(computeDelassusMatrix(k, d, at, c)); }, model,
      data, q, constraints, "Returns J M^-1 J^T (rows, rows) [1/kg, 1/(kg m^2)].");
  m.def(
      "compute_operational_space_inertia",
      [](const CompactModel& k, Data& d, const Vector& at, ConstraintData& c) {
        return Eigen::MatrixXd(computeOperationalSpaceInertia(k, d, at, c));
      },
      model, data, q, constraints, "Returns the inverse (rows, rows) of the Delassus matrix; its pseudo-inverse if rows are redundant.");
  py::class_<DelassusOperator>(m, "DelassusOperator",
                               "The Delassus matrix at one q as an operator, in O(n) a product. No other algorithm may use its data and constraints "
                               "until the last product.")
      .def(py::init([](const CompactModel& k, Data& d, const Vector& at, ConstraintData& c) { return DelassusOperator(k, d, at, c); }), model, data,
           q, constraints, py::keep_alive<1, 2>(), py::keep_alive<1, 3>(), py::keep_alive<1, 5>())
      .def("apply", &applied, x, "Returns J M^-1 J^T x (rows,).")
      .def("__matmul__", &applied, py::is_operator());

  py::class_<Assembled>(m, "Assembly", "The result of project_configuration.")
      .def_readonly("q", &Assembled::q, "(nq,)")
      .def_readonly("error", &Assembled::error, "The largest error of a row [m, rad].")
      .def_readonly("closed", &Assembled::closed, "Whether the error is within the tolerance.")
      .def_readonly("iterations", &Assembled::iterations, "Newton steps taken.");
  const AssemblySettings standard;
  const py::arg_v tolerance("tolerance", standard.tolerance), most("max_iterations", standard.max_iterations);
  m.def(
      "project_configuration",
      [](const CompactModel& k, Data& d, const Vector& at, ConstraintData& c, double accuracy, int iterations) {
        const Assembly r = projectConfiguration(k, d, at, c, {accuracy, iterations});
        return Assembled{r.q, r.error, r.closed, r.iterations};
      },
      model, data, q, constraints, py::kw_only(), tolerance, most,
      "Moves q to a configuration where the frames of constraints with a target coincide, and couplings and locks hold; returns an Assembly.\n\n"
      "tolerance: the largest error of a row [m, rad] that counts as closed. A q that does not close is no error: see `closed`.");
  m.def(
      "assemble",
      [](const CompactModel& k, Data& d, const Vector& at, ConstraintData& c, double accuracy, int iterations) {
        Eigen::VectorXd closed = at;
        assemble(k, d, closed, c, {accuracy, iterations});
        return closed;
      },
      model, data, q, constraints, py::kw_only(), tolerance, most,
      "Returns the closed configuration (nq,) near the guess q. Raises Error with the code 'closure', naming the constraint, if there is none.");
  m.def(
      "project_velocity",
      [](const CompactModel& k, Data& d, const Vector& at, const Vector& w, ConstraintData& c) {
        return Eigen::VectorXd(projectVelocity(k, d, at, w, c));
      },
      model, data, q, v, constraints, "Returns the velocity (nv,) with J v = 0 that is nearest to v in the metric of the kinetic energy.");
}

}  // namespace dyn::python
