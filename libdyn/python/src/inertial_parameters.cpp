// SPDX-License-Identifier: BSD-2-Clause
// Parameters of an inertia for identification.
#include "module.hpp"

#include <dyn/spatial/inertial_parameters.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Ten = Eigen::Matrix<double, 10, 1>;
using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

std::array<double, 10> arrayOf(const Ten& x) {
  std::array<double, 10> out;
  std::copy_n(x.data(), 10, out.begin());
  return out;
}
Ten tenOf(const std::array<double, 10>& x) { return Ten(x.data()); }
PseudoInertia arrayOf(const Matrix4& J) {
  PseudoInertia out;
  std::copy_n(J.data(), 16, out.begin());
  return out;
}
Matrix4 matrixOf(const PseudoInertia& J) { return Matrix4(J.data()); }

}  // namespace

void addInertialParameters(py::module_& m) {
  const py::arg inertia("inertia"), pi("pi"), J("J"), theta("theta");
  m.def(
      "to_dynamic_parameters", [](const Inertia<double>& Y) { return tenOf(toDynamicParameters(Y)); }, inertia,
      "Returns pi = (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) (10,) [kg, kg m, kg m^2], about the frame's origin.");
  m.def(
      "inertia_from_dynamic_parameters", [](const Ten& x) { return inertiaFromDynamicParameters(arrayOf(x)); }, pi,
      "Returns the Inertia with these dynamic parameters.");
  m.def(
      "pseudo_inertia", [](const Ten& x) { return matrixOf(pseudoInertia(arrayOf(x))); }, pi,
      "Returns [[Sigma, m c], [m c^T, m]] (4, 4) of a body with these dynamic parameters. It is positive definite for a body of positive density.");
  m.def(
      "dynamic_parameters_of_pseudo_inertia", [](const Matrix4& x) { return tenOf(dynamicParameters(arrayOf(x))); }, J,
      "Returns the dynamic parameters (10,) of a body with this pseudo-inertia (4, 4), whose upper triangle is read.");
  m.def(
      "log_cholesky", [](const Matrix4& x) { return tenOf(logCholesky(arrayOf(x))); }, J,
      "Returns theta = (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3) (10,) of a positive definite pseudo-inertia (4, 4).");
  m.def(
      "pseudo_inertia_from_log_cholesky", [](const Ten& x) { return matrixOf(pseudoInertiaFromLogCholesky(arrayOf(x))); }, theta,
      "Returns the pseudo-inertia (4, 4) of any parameters theta (10,).");
  py::class_<PhysicalConsistency>(m, "PhysicalConsistency", "Whether a body of positive density can have an inertia.")
      .def_readonly("consistent", &PhysicalConsistency::consistent, "Whether a body of positive density can have the inertia.")
      .def_readonly("margin", &PhysicalConsistency::margin, "The smallest principal second moment, relative to the largest one.")
      .def("__bool__", [](const PhysicalConsistency& x) { return x.consistent; });
  m.def("physical_consistency", &physicalConsistency, inertia, "Finds whether a body of positive density can have an inertia.");
}

}  // namespace dyn::python
