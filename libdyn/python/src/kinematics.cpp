// SPDX-License-Identifier: BSD-2-Clause
// Kinematics of joints and frames, Jacobians, the centre of mass and energies. Joints and frames are given by name or number.
#include "names.hpp"

#include <dyn/algorithm/center_of_mass.hpp>
#include <dyn/algorithm/jacobians.hpp>
#include <dyn/error.hpp>
#include <dyn/spatial/eigen.hpp>

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <optional>

namespace dyn::python {

namespace {

using Vector = Eigen::Ref<const Eigen::VectorXd>;
using MaybeVector = std::optional<Vector>;

/// Calls use(), use(v) or use(v, a), as far as they are given.
template <class Use>
auto withGiven(const char* function, const MaybeVector& v, const MaybeVector& a, const Use& use) {
  if (a && !v) throw Error(ErrorCode::argument, std::string(function) + ": a without v; give v, too");
  return a ? use(*v, *a) : v ? use(*v) : use();
}

void forward(const CompactModel& model, Data& data, const Vector& q, const MaybeVector& v, const MaybeVector& a) {
  withGiven("forward_kinematics", v, a, [&](const auto&... given) { forwardKinematics(model, data, q, given...); });
}

CenterOfMass centre(const CompactModel& model, Data& data, const Vector& q, const MaybeVector& v, const MaybeVector& a) {
  return withGiven("center_of_mass", v, a, [&](const auto&... given) { return centerOfMass(model, data, q, given...); });
}

}  // namespace

void addKinematics(py::module_& m) {
  const py::arg model("model"), data("data"), q("q"), v("v"), joint("joint"), frame("frame");
  py::enum_<ReferenceFrame>(m, "ReferenceFrame", "The axes and the point in which a velocity, acceleration or Jacobian is expressed.")
      .value("LOCAL", ReferenceFrame::LOCAL, "the frame's axes, at the frame's origin")
      .value("WORLD", ReferenceFrame::WORLD, "world axes, at the body's point that coincides with the world's origin")
      .value("LOCAL_WORLD_ALIGNED", ReferenceFrame::LOCAL_WORLD_ALIGNED, "world axes, at the frame's origin")
      .export_values();
  const py::arg_v reference("reference", ReferenceFrame::LOCAL, "LOCAL");

  m.def("forward_kinematics", &forward, model, data, q, py::arg("v") = py::none(), py::arg("a") = py::none(),
        "Computes the poses of all joints; with v their velocities, too; with a also their accelerations.");
  m.def(
      "joint_placement", [](const CompactModel& x, const Data& d, const Name& i) { return jointPlacement(x, d, jointOf(x, i)); }, model, data, joint,
      "Returns the pose of a joint in the world, as the last forward_kinematics found it.");
  m.def(
      "frame_placement", [](const CompactModel& x, const Data& d, const Name& i) { return framePlacement(x, d, frameOf(x, i)); }, model, data, frame,
      "Returns the pose of a frame in the world, as the last forward_kinematics found it.");
  const auto motion = [&](const char* name, auto function, auto number, const py::arg& which, const char* doc) {
    m.def(
        name, [function, number](const CompactModel& x, const Data& d, const Name& i, ReferenceFrame r) { return function(x, d, number(x, i), r); },
        model, data, which, reference, doc);
  };
  motion("joint_velocity", &jointVelocity, &jointOf, joint, "Returns the spatial velocity of a joint [m/s, rad/s].");
  motion("frame_velocity", static_cast<Motion<double> (*)(const CompactModel&, const Data&, int, ReferenceFrame)>(&frameVelocity), &frameOf, frame,
         "Returns the spatial velocity of a frame [m/s, rad/s].");
  motion("joint_acceleration", &jointAcceleration, &jointOf, joint, "Returns the spatial acceleration of a joint [m/s^2, rad/s^2], without gravity.");
  motion("frame_acceleration", static_cast<Motion<double> (*)(const CompactModel&, const Data&, int, ReferenceFrame)>(&frameAcceleration), &frameOf,
         frame, "Returns the spatial acceleration of a frame [m/s^2, rad/s^2], without gravity.");
  motion("joint_classical_acceleration", &jointClassicalAcceleration, &jointOf, joint,
         "Returns the acceleration of a joint's origin, and that of its rotation. The reference is not WORLD.");
  motion("frame_classical_acceleration", &frameClassicalAcceleration, &frameOf, frame,
         "Returns the acceleration of a frame's origin, and that of its rotation. The reference is not WORLD.");

  const auto jacobian = [&](const char* name, auto write, auto number, const py::arg& which, const char* doc) {
    m.def(
        name,
        [write, number](const CompactModel& x, Data& d, const Vector& at, const Name& i, ReferenceFrame r) {
          Eigen::MatrixXd J(6, x.nv());
          write(x, d, at, number(x, i), r, J);
          return J;
        },
        model, data, q, which, reference, doc);
  };
  jacobian(
      "compute_joint_jacobian", [](auto& x, auto& d, auto& at, int i, auto r, auto& J) { computeJointJacobian(x, d, at, i, r, J); }, &jointOf, joint,
      "Returns the Jacobian of a joint (6, nv) in `reference`, linear part first.");
  jacobian(
      "compute_frame_jacobian", [](auto& x, auto& d, auto& at, int i, auto r, auto& J) { computeFrameJacobian(x, d, at, i, r, J); }, &frameOf, frame,
      "Returns the Jacobian of a frame, (6, nv), linear part first.");
  const auto present = [&](const char* name, auto write, auto number, const py::arg& which, const char* doc) {
    m.def(
        name,
        [write, number](const CompactModel& x, Data& d, const Name& i, ReferenceFrame r) {
          Eigen::MatrixXd J(6, x.nv());
          write(x, d, number(x, i), r, J);
          return J;
        },
        model, data, which, reference, doc);
  };
  present("get_joint_jacobian", &getJointJacobian, &jointOf, joint,
          "Returns the Jacobian of a joint (6, nv) at the q of the last forward_kinematics or compute_joint_jacobians.");
  present("get_frame_jacobian", &getFrameJacobian, &frameOf, frame,
          "Returns the Jacobian of a frame (6, nv) at the q of the last forward_kinematics or compute_joint_jacobians.");
  m.def(
      "compute_jacobian_at",
      [](const CompactModel& x, Data& d, const Vector& at, const Name& which, const SE3<double>& placement, ReferenceFrame r) {
        const int i = jointOf(x, which);
        Eigen::MatrixXd J(6, x.nv());
        computeJointJacobian(x, d, at, i, r == ReferenceFrame::WORLD ? r : ReferenceFrame::LOCAL, J);
        if (r == ReferenceFrame::WORLD) return J;
        J = (actionMatrix6(placement.inverse()) * J).eval();
        if (r == ReferenceFrame::LOCAL_WORLD_ALIGNED) {
          forwardKinematics(x, d, at);
          const Eigen::Matrix3d R = toEigen(jointPlacement(x, d, i).R * placement.R);
          J.topRows<3>() = (R * J.topRows<3>()).eval();
          J.bottomRows<3>() = (R * J.bottomRows<3>()).eval();
        }
        return J;
      },
      model, data, q, joint, py::arg("placement"), reference,
      "Returns the Jacobian (6, nv) of the frame at `placement` in the frame of a joint, linear part first.");
  const auto variation = [&](const char* name, auto write, auto number, const py::arg& which, const char* doc) {
    m.def(
        name,
        [write, number](const CompactModel& x, Data& d, const Vector& at, const Vector& along, const Name& i, ReferenceFrame r) {
          Eigen::MatrixXd J(6, x.nv());
          write(x, d, at, along, number(x, i), r, J);
          return J;
        },
        model, data, q, v, which, reference, doc);
  };
  variation(
      "compute_joint_jacobian_time_variation",
      [](auto& x, auto& d, auto& at, auto& along, int i, auto r, auto& J) { computeJointJacobianTimeVariation(x, d, at, along, i, r, J); }, &jointOf,
      joint, "Returns the rate of the Jacobian of a joint along v, (6, nv) in `reference`.");
  variation(
      "compute_frame_jacobian_time_variation",
      [](auto& x, auto& d, auto& at, auto& along, int i, auto r, auto& J) { computeFrameJacobianTimeVariation(x, d, at, along, i, r, J); }, &frameOf,
      frame, "Returns the rate of the Jacobian of a frame along v, (6, nv) in `reference`.");

  py::class_<CenterOfMass>(m, "CenterOfMass", "The centre of mass and its motion, in world axes.")
      .def_property_readonly(
          "position", [](const CenterOfMass& c) { return toEigen(c.position); }, "The position (3,) [m].")
      .def_property_readonly(
          "velocity", [](const CenterOfMass& c) { return toEigen(c.velocity); }, "The velocity (3,) [m/s]; zero unless v was given.")
      .def_property_readonly(
          "acceleration", [](const CenterOfMass& c) { return toEigen(c.acceleration); }, "The acceleration (3,) [m/s^2]; zero unless a was given.");
  m.def("center_of_mass", &centre, model, data, q, py::arg("v") = py::none(), py::arg("a") = py::none(),
        "Returns the centre of mass; with v its velocity, too; with a also its acceleration.");
  m.def(
      "compute_kinetic_energy", [](const CompactModel& x, Data& d, const Vector& at, const Vector& w) { return computeKineticEnergy(x, d, at, w); },
      model, data, q, v, "Returns v^T M v / 2 [J].");
  m.def(
      "compute_potential_energy", [](const CompactModel& x, Data& d, const Vector& at) { return computePotentialEnergy(x, d, at); }, model, data, q,
      "Returns the potential energy [J].");
}

}  // namespace dyn::python
