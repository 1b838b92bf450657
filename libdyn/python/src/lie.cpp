// SPDX-License-Identifier: BSD-2-Clause
// Exponentials, logarithms and their Jacobians on SO(3) and SE(3).
#include "module.hpp"

#include <dyn/lie/se3.hpp>
#include <dyn/spatial/eigen.hpp>

#include <Eigen/LU>

#include <pybind11/eigen.h>

namespace dyn::python {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Mat3<double> rotation(const Matrix3& R, const char* function) {
  if (!(R.transpose() * R).isIdentity(1e-9) || !(R.determinant() > 0))
    throw Error(ErrorCode::argument, std::string(function) + ": R is not a rotation");
  return rotationFromEigen(R);
}

Matrix6 matrixOf(const Jacobian6<double>& J) {
  Matrix6 out;
  out << toEigen(J.diagonal), toEigen(J.upper), Matrix3::Zero(), toEigen(J.diagonal);
  return out;
}

}  // namespace

void addLie(py::module_& m) {
  const py::arg w("w"), R("R"), motion("motion"), pose("pose"), quaternion("quaternion");
  m.def(
      "exp3", [](const Vector3& x) { return toEigen(exp3(fromEigen3(x))); }, w, "Returns the rotation (3, 3) by |w| [rad] about w.");
  m.def(
      "log3", [](const Matrix3& x) { return toEigen(log3(rotation(x, "log3"))); }, R,
      "Returns the rotation vector (3,) [rad] of a rotation, of length at most pi.");
  m.def(
      "Jexp3", [](const Vector3& x) { return toEigen(Jexp3(fromEigen3(x))); }, w,
      "Returns the right Jacobian (3, 3) of exp3: exp3(w + d) = exp3(w) exp3(J d + ...).");
  m.def(
      "Jlog3", [](const Vector3& x) { return toEigen(Jlog3(fromEigen3(x))); }, w, "Returns the inverse (3, 3) of Jexp3 at the rotation vector w.");
  m.def(
      "exp6", [](const Motion<double>& x) { return exp6(x); }, motion, "Returns the pose after unit time of a constant motion [m, rad].");
  m.def(
      "log6", [](const SE3<double>& x) { return log6(x); }, pose, "Returns the constant motion that leads to the pose in unit time.");
  m.def(
      "Jexp6", [](const Motion<double>& x) { return matrixOf(Jexp6(x)); }, motion, "Returns the right Jacobian (6, 6) of exp6, linear part first.");
  m.def(
      "Jlog6", [](const Motion<double>& x) { return matrixOf(Jlog6(x)); }, motion,
      "Returns the inverse (6, 6) of Jexp6 at a motion, such as log6 of a pose.");
  m.def(
      "quaternion_of",
      [](const Matrix3& x) {
        const Quaternion<double> q = quaternionOf(rotation(x, "quaternion_of"));
        return Eigen::Vector4d(q.x, q.y, q.z, q.w);
      },
      R, "Returns the unit quaternion (x, y, z, w) of a rotation.");
  m.def(
      "rotation_of",
      [](const Eigen::Vector4d& x) {
        if (!x.allFinite() || x.isZero(0)) throw Error(ErrorCode::argument, "rotation_of: the quaternion is zero or not finite");
        return toEigen(Quaternion<double>{x[0], x[1], x[2], x[3]}.normalized().matrix());
      },
      quaternion, "Returns the rotation (3, 3) of a quaternion (x, y, z, w), which need not have norm one.");
}

}  // namespace dyn::python
