// SPDX-License-Identifier: BSD-2-Clause
// Exponentials, logarithms and their Jacobians. Rotations are matrices or unit quaternions (x, y, z, w).
#include "module.hpp"

#include <dyn/error.hpp>
#include <dyn/lie/se3.hpp>
#include <dyn/scalar/dual.hpp>
#include <dyn/spatial/eigen.hpp>

#include <Eigen/LU>

#include <pybind11/eigen.h>

namespace dyn::python {

namespace {

using Vector3 = Eigen::Vector3d;
using Vector4 = Eigen::Vector4d;
using Matrix3 = Eigen::Matrix3d;

Vector4 toVector(const Quaternion<double>& q) { return {q.x, q.y, q.z, q.w}; }
Quaternion<double> fromVector(const Vector4& x) {
  if (!x.allFinite() || x.isZero(0)) throw Error(ErrorCode::argument, "quaternion: it is zero or not finite; it must be a rotation");
  return {x[0], x[1], x[2], x[3]};
}

Mat3<double> rotation(const Matrix3& R, bool check) {
  if (check && (!(R.transpose() * R).isIdentity(1e-9) || !(R.determinant() > 0))) throw Error(ErrorCode::argument, "R: it is no rotation");
  return rotationFromEigen(R);
}

Matrix6<double> dense(const Jacobian6<double>& J) {
  Matrix6<double> out = Matrix6<double>::Zero();
  out.topLeftCorner<3, 3>() = out.bottomRightCorner<3, 3>() = toEigen(J.diagonal);
  out.topRightCorner<3, 3>() = toEigen(J.upper);
  return out;
}

/// Returns the derivative of Jlog3 at w in the direction Jlog3(w) v.
Mat3<double> jlog3Rate(const Vec3<double>& w, const Vec3<double>& v) {
  const Vec3<double> d = Jlog3(w) * v;
  const Mat3<Dual<double>> J = Jlog3(Vec3<Dual<double>>{{w.x, d.x}, {w.y, d.y}, {w.z, d.z}});
  Mat3<double> out;
  for (int k = 0; k < 9; ++k) out.m[k] = J.m[k].d;
  return out;
}

}  // namespace

void addLie(py::module_& m) {
  const py::arg w("w"), motion("motion"), R("R"), quaternion("quaternion");
  const py::arg_v check("check", true);
  m.def(
      "exp3", [](const Vector3& x) { return toEigen(exp3(fromEigen3(x))); }, w,
      "Returns the rotation matrix (3, 3) of a rotation vector (3,) [rad].");
  m.def(
      "exp3_quaternion", [](const Vector3& x) { return toVector(expQuaternion(fromEigen3(x))); }, w,
      "Returns the unit quaternion (x, y, z, w) of a rotation vector (3,) [rad].");
  m.def(
      "log3", [](const Matrix3& x, bool checked) { return toEigen(log3(rotation(x, checked))); }, R, py::kw_only(), check,
      "Returns the rotation vector (3,) [rad] of a rotation matrix; its norm is at most pi. Raises Error if R is no rotation, unless check is "
      "False.");
  m.def(
      "log3_quaternion", [](const Vector4& x) { return toEigen(log3(fromVector(x))); }, quaternion,
      "Returns the rotation vector (3,) [rad] of a unit quaternion (x, y, z, w); its norm is at most pi.");
  m.def(
      "Jexp3", [](const Vector3& x) { return toEigen(Jexp3(fromEigen3(x))); }, w,
      "Returns the right Jacobian (3, 3) of exp3: exp3(w + d) = exp3(w) exp3(J d) for small d.");
  m.def(
      "Jlog3", [](const Vector3& x) { return toEigen(Jlog3(fromEigen3(x))); }, w,
      "Returns the inverse of Jexp3(w) (3, 3). It is the Jacobian of log3 at exp3(w) if |w| is at most pi.");
  m.def(
      "Hlog3", [](const Vector3& x, const Vector3& v) { return toEigen(jlog3Rate(fromEigen3(x), fromEigen3(v))); }, w, py::arg("v"),
      "Returns the derivative (3, 3) of Jlog3 at w, while the rotation moves with angular velocity v in its own frame.");
  m.def(
      "exp6", [](const Motion<double>& x) { return exp6(x); }, motion, "Returns the pose after unit time of a constant motion [m, rad].");
  m.def(
      "log6", [](const SE3<double>& x) { return log6(x); }, py::arg("pose"), "Returns the constant motion that leads to the pose in unit time.");
  m.def(
      "Jexp6", [](const Motion<double>& x) { return dense(Jexp6(x)); }, motion, "Returns the right Jacobian (6, 6) of SE3.exp, linear part first.");
  m.def(
      "Jlog6", [](const Motion<double>& x) { return dense(Jlog6(x)); }, motion,
      "Returns the inverse of Jexp6(motion) (6, 6). It is the Jacobian of SE3.log at SE3.exp(motion) if the angle is at most pi.");
  m.def(
      "quaternion_of", [](const Matrix3& x, bool checked) { return toVector(quaternionOf(rotation(x, checked))); }, R, py::kw_only(), check,
      "Returns the unit quaternion x, y, z, w (4,) of a rotation matrix (3, 3), with w >= 0. Raises Error if R is no rotation, unless check is "
      "False.");
  m.def(
      "rotation_of", [](const Vector4& x) { return toEigen(fromVector(x).matrix()); }, quaternion,
      "Returns the rotation matrix (3, 3) of a quaternion (x, y, z, w) of any norm but zero.");
}

}  // namespace dyn::python
