// SPDX-License-Identifier: BSD-2-Clause
// Poses, motions, forces and inertias. Their parts are views: a change of `X.p[0]` changes X.
#include "printing.hpp"

#include <dyn/error.hpp>
#include <dyn/lie/se3.hpp>
#include <dyn/spatial/eigen.hpp>
#include <dyn/spatial/inertia.hpp>

#include <Eigen/LU>

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/operators.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>

namespace dyn::python {

namespace {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Six = Eigen::Matrix<double, 6, 1>;

Sym3<double> sym3(const Matrix3& A) { return {A(0, 0), A(0, 1), A(0, 2), A(1, 1), A(1, 2), A(2, 2)}; }

/// Returns an array that views numbers of `owner`, which it keeps alive.
py::array_t<double> view(const py::object& owner, double* first, std::vector<py::ssize_t> shape) {
  std::vector<py::ssize_t> strides = shape.size() == 1 ? std::vector<py::ssize_t>{8} : std::vector<py::ssize_t>{8 * shape[1], 8};
  return py::array_t<double>(std::move(shape), std::move(strides), first, owner);
}

/// Adds a property of three numbers.
template <class T, class Class>
void vectorProperty(Class& c, const char* name, Vec3<double> T::*member, const char* doc) {
  c.def_property(
      name, [member](const py::object& self) { return view(self, &(py::cast<T&>(self).*member).x, {3}); },
      [member](T& self, const Vector3& x) { self.*member = fromEigen3(x); }, doc);
}

/// Adds copies, and pickling by the constructor's arguments.
template <class Class, class Arguments>
void copies(Class& c, const Arguments& arguments) {
  using T = typename Class::type;
  c.def(py::init<const T&>(), py::arg("other"));
  c.def("__copy__", [](const T& x) { return x; });
  c.def(
      "__deepcopy__", [](const T& x, const py::dict&) { return x; }, py::arg("memo"));
  c.def("__reduce__", [arguments](const py::object& self) { return py::make_tuple(py::type::of(self), arguments(py::cast<const T&>(self))); });
}

/// Motions and forces: two vectors, linear part first.
template <class T>
py::class_<T> addPair(py::module_& m, const char* name, const char* doc, const char* linear, const char* angular) {
  py::class_<T> c(m, name, doc);
  const auto parts = [](const T& x) { return py::make_tuple(toEigen(x.linear), toEigen(x.angular)); };
  c.def(py::init([](const Vector3& l, const Vector3& a) {
          return T{fromEigen3(l), fromEigen3(a)};
        }),
        py::arg("linear") = Vector3::Zero().eval(), py::arg("angular") = Vector3::Zero().eval());
  c.def(py::init([](const Six& x) { return T{{x[0], x[1], x[2]}, {x[3], x[4], x[5]}}; }), py::arg("vector"));
  vectorProperty(c, "linear", &T::linear, linear);
  vectorProperty(c, "angular", &T::angular, angular);
  static_assert(sizeof(T) == 6 * sizeof(double));
  c.def_property(
      "vector", [](const py::object& self) { return view(self, &py::cast<T&>(self).linear.x, {6}); },
      [](T& self, const Six& x) {
        self = {{x[0], x[1], x[2]}, {x[3], x[4], x[5]}};
      },
      "The six numbers (6,), linear part first, as a view.");
  c.def(py::self + py::self).def(py::self - py::self).def(double() * py::self).def(py::self += py::self).def(py::self -= py::self);
  c.def(
      "__mul__", [](const T& x, double s) { return s * x; }, py::is_operator());
  c.def("__neg__", [](const T& x) { return -1.0 * x; });
  c.def(
      "__eq__", [](const T& x, const T& y) { return toEigen(x) == toEigen(y); }, py::is_operator());
  copies(c, parts);
  printed(c, parts);
  return c;
}

}  // namespace

void addSpatial(py::module_& m) {
  auto motion = addPair<Motion<double>>(m, "Motion", "A spatial velocity or acceleration, linear part first.",
                                        "The part of the point at the frame's origin (3,) [m/s or m/s^2], as a view.",
                                        "The rotation's part (3,) [rad/s or rad/s^2], as a view.");
  addPair<Force<double>>(m, "Force", "A spatial force, force first and moment second.", "The force (3,) [N], as a view.",
                         "The moment about the frame's origin (3,) [N m], as a view.");
  motion
      .def("cross", &Motion<double>::cross, py::arg("x"),
           "Returns the derivative of a motion or force that is fixed in a frame that moves with this motion.")
      .def(
          "cross", [](const Motion<double>& v, const Force<double>& f) { return crossStar(v, f); }, py::arg("x"));

  // All classes are there before functions whose signatures name them.
  using X = SE3<double>;
  py::class_<X> pose(m, "SE3", "The pose aMb of frame b in frame a: x_a = R x_b + p.");
  using Y = Inertia<double>;
  py::class_<Y> inertia(m, "Inertia", "The inertia of a rigid body, in the body's frame.");
  const auto inertia_parts = [](const Y& y) { return py::make_tuple(y.mass, toEigen(y.com), toEigen(y.rotational)); };
  inertia
      .def(py::init([](double mass, const Vector3& com, const Matrix3& rotational) {
             if (!rotational.isApprox(rotational.transpose(), 1e-12) && !rotational.isZero(0))
               throw Error(ErrorCode::argument, "Inertia: the rotational inertia is not symmetric");
             return Y{mass, fromEigen3(com), sym3(rotational)};
           }),
           py::arg("mass") = 0.0, py::arg("com") = Vector3::Zero().eval(), py::arg("rotational") = Matrix3::Zero().eval())
      .def_readwrite("mass", &Y::mass, "The mass [kg].")
      .def_property(
          "rotational", [](const Y& y) { return toEigen(y.rotational); }, [](Y& y, const Matrix3& A) { y.rotational = sym3(A); },
          "The rotational inertia about the centre of mass [kg m^2], as a new array (3, 3).")
      .def_property_readonly(
          "matrix", [](const Y& y) { return toEigen(y); }, "The matrix (6, 6) that maps a motion to a momentum, as a new array.")
      .def("transformed", &Y::transformed, py::arg("aMb"), "Returns the same inertia in frame a.")
      .def(py::self + py::self)
      .def(
          "__matmul__", [](const Y& y, const Motion<double>& v) { return y * v; }, py::is_operator());
  vectorProperty(inertia, "com", &Y::com, "The centre of mass (3,) [m], as a view.");
  copies(inertia, inertia_parts);
  printed(inertia, inertia_parts);

  using Points = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
  const auto mapped = [](const X& x, const Points& points) -> Points {
    return (points * toEigen(x.R).transpose()).rowwise() + toEigen(x.p).transpose();
  };
  const auto pose_parts = [](const X& x) { return py::make_tuple(toEigen(x.R), toEigen(x.p)); };
  const auto of = [](const Matrix3& R, const Vector3& p, bool check) {
    if (check && (!(R.transpose() * R).isIdentity(1e-9) || !(R.determinant() > 0))) throw Error(ErrorCode::argument, "SE3: R is not a rotation");
    return X{rotationFromEigen(R), fromEigen3(p)};
  };
  pose.def(py::init(of), py::arg("R") = Matrix3::Identity().eval(), py::arg("p") = Vector3::Zero().eval(), py::kw_only(), py::arg("check") = true,
           "Raises Error if R is no rotation, unless check is False.")
      .def(py::init([of](const Eigen::Matrix4d& H) { return of(H.topLeftCorner<3, 3>(), H.topRightCorner<3, 1>(), true); }), py::arg("homogeneous"))
      .def_static(
          "translation",
          [](double x, double y, double z) {
            return X{Mat3<double>::identity(), {x, y, z}};
          },
          py::arg("x"), py::arg("y"), py::arg("z"), "Returns a pose without rotation; x, y and z in [m].")
      .def_static(
          "rotation",
          [](const Vector3& vector, const std::optional<double>& angle) {
            Vector3 w = vector;
            if (angle) {
              const double length = vector.stableNorm();
              if (!(length > 0) || !std::isfinite(length))
                throw Error(ErrorCode::argument, "SE3.rotation: the axis must be finite and other than zero");
              w *= *angle / length;
            }
            return X{exp6(Motion<double>{{}, fromEigen3(w)}).R, {}};
          },
          py::arg("vector"), py::arg("angle") = py::none(),
          "Returns a rotation by |vector| [rad] about the vector (3,), or by `angle` [rad] about it.")
      .def_static(
          "exp", [](const Motion<double>& v) { return exp6(v); }, py::arg("motion"), "Returns the pose after unit time of a constant motion.")
      .def(
          "log", [](const X& x) { return log6(x); }, "Returns the constant motion that leads here in unit time.")
      .def_property_readonly(
          "R",
          [](const py::object& self) {
            return view(self, py::cast<X&>(self).R.m, {3, 3});
          },
          "The rotation (3, 3), as a view; its columns are b's axes in a.")
      .def_property_readonly(
          "homogeneous", [](const X& x) { return toEigen(x); }, "The matrix [[R, p], [0, 1]] (4, 4), as a new array.")
      .def_property_readonly(
          "action", [](const X& x) { return actionMatrix6(x); }, "The matrix (6, 6) that maps motions from b to a, as a new array.")
      .def("inverse", &X::inverse, "Returns bMa.")
      .def(
          "act", [](const X& x, const Motion<double>& v) { return x.act(v); }, py::arg("x"),
          "Maps a motion, force, inertia, point (3,) or points (n, 3) from b to a.")
      .def(
          "act", [](const X& x, const Force<double>& f) { return x.act(f); }, py::arg("x"))
      .def(
          "act", [](const X& x, const Y& y) { return y.transformed(x); }, py::arg("x"))
      .def(
          "act", [](const X& x, const Vector3& p) { return toEigen(x.act(fromEigen3(p))); }, py::arg("x"))
      .def("act", mapped, py::arg("x"))
      .def(
          "act_inverse", [](const X& x, const Motion<double>& v) { return x.actInv(v); }, py::arg("x"),
          "Maps a motion, force, inertia, point (3,) or points (n, 3) from a to b.")
      .def(
          "act_inverse", [](const X& x, const Force<double>& f) { return x.actInv(f); }, py::arg("x"))
      .def(
          "act_inverse", [](const X& x, const Y& y) { return y.transformed(x.inverse()); }, py::arg("x"))
      .def(
          "act_inverse", [](const X& x, const Vector3& p) { return toEigen(x.actInv(fromEigen3(p))); }, py::arg("x"))
      .def(
          "act_inverse", [mapped](const X& x, const Points& points) { return mapped(x.inverse(), points); }, py::arg("x"))
      .def(
          "__mul__", [](const X& a, const X& b) { return a * b; }, py::is_operator())
      .def(
          "__matmul__", [](const X& a, const X& b) { return a * b; }, py::is_operator())
      .def(
          "__matmul__", [](const X& a, const Motion<double>& v) { return a.act(v); }, py::is_operator())
      .def(
          "__matmul__", [](const X& a, const Force<double>& f) { return a.act(f); }, py::is_operator())
      .def(
          "__matmul__", [](const X& a, const Y& y) { return y.transformed(a); }, py::is_operator())
      .def(
          "__matmul__", [](const X& a, const Vector3& p) { return toEigen(a.act(fromEigen3(p))); }, py::is_operator())
      .def("__matmul__", mapped, py::is_operator())
      .def(
          "__eq__", [](const X& a, const X& b) { return toEigen(a) == toEigen(b); }, py::is_operator());
  vectorProperty(pose, "p", &X::p, "The origin of b in a (3,) [m], as a view.");
  copies(pose, pose_parts);
  printed(pose, pose_parts);
}

}  // namespace dyn::python
