// SPDX-License-Identifier: BSD-2-Clause
// Parameters of an inertia for identification.
#include "module.hpp"

#include <dyn/spatial/eigen.hpp>
#include <dyn/spatial/inertial_parameters.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

namespace dyn::python {

namespace {

using Matrix4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

Matrix4 toMatrix(const PseudoInertia& J) { return Eigen::Map<const Matrix4>(J.data()); }
PseudoInertia fromMatrix(const Matrix4& A) {
  PseudoInertia J;
  Eigen::Map<Matrix4>(J.data()) = A;
  return J;
}
Eigen::VectorXd toVector(const std::array<double, 10>& x) { return Eigen::Map<const Eigen::VectorXd>(x.data(), 10); }

}  // namespace

void addInertialParameters(py::module_& m) {
  const py::arg inertia("inertia"), parameters("parameters"), J("J");
  m.def(
      "to_dynamic_parameters", [](const Inertia<double>& Y) { return toVector(toDynamicParameters(Y)); }, inertia,
      "Returns (m, m cx, m cy, m cz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz) (10,), with the rotational inertia about the frame's origin.");
  m.def("inertia_from_dynamic_parameters", &inertiaFromDynamicParameters, parameters, "Returns the Inertia with these ten dynamic parameters.");
  m.def(
      "pseudo_inertia", [](const DynamicParameters& x) { return toMatrix(pseudoInertia(x)); }, parameters,
      "Returns the pseudo-inertia [[Sigma, m c], [m c', m]] (4, 4) of ten dynamic parameters; Sigma is the sum of m x x'.");
  m.def(
      "dynamic_parameters_of_pseudo_inertia", [](const Matrix4& A) { return toVector(dynamicParameters(fromMatrix(A))); }, J,
      "Returns the ten dynamic parameters of a pseudo-inertia (4, 4), whose upper triangle is read.");
  m.def(
      "pseudo_inertia_from_log_cholesky", [](const LogCholeskyParameters& x) { return toMatrix(pseudoInertiaFromLogCholesky(x)); }, parameters,
      "Returns the pseudo-inertia U U' (4, 4) of ten parameters (alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3).");
  m.def(
      "log_cholesky", [](const Matrix4& A) { return toVector(logCholesky(fromMatrix(A))); }, J,
      "Returns the ten log-Cholesky parameters of a positive definite pseudo-inertia (4, 4).");
  py::class_<PhysicalConsistency>(m, "PhysicalConsistency", "Whether a body of positive density can have an inertia; true in an `if` if it can.")
      .def_readonly("consistent", &PhysicalConsistency::consistent, "Whether it can.")
      .def_readonly("margin", &PhysicalConsistency::margin, "The smallest principal second moment, relative to the largest one.")
      .def("__bool__", [](const PhysicalConsistency& x) { return x.consistent; });
  m.def("physical_consistency", &physicalConsistency, inertia, "Finds whether a body of positive density can have an inertia.");
}

}  // namespace dyn::python
