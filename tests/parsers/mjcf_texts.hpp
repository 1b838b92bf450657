// SPDX-License-Identifier: BSD-2-Clause
// Short MJCF texts, and their parts by name.
#pragma once

#include "support/catch.hpp"

#include <dyn/parsers/mjcf.hpp>
#include <dyn/spatial/eigen.hpp>

#include <Eigen/Geometry>

#include <algorithm>

namespace dyn::test {

inline constexpr double pi = 3.14159265358979323846;

inline std::string mujoco(const std::string& world, const std::string& before = "") {
  return "<mujoco model=\"m\">\n" + before + "<worldbody>\n" + world + "</worldbody>\n</mujoco>\n";
}
inline Model read(const std::string& world, const std::string& before = "") { return mjcf::parse(mujoco(world, before), "robot.xml"); }

inline const BodyDescription& bodyOf(const Model& model, const std::string& name) {
  const int i = model.findBody(name);
  REQUIRE(i >= 0);
  return model.bodies[static_cast<std::size_t>(i)];
}
inline const JointDescription& jointOf(const Model& model, const std::string& name) {
  const int i = model.findJoint(name);
  REQUIRE(i >= 0);
  return model.bodies[static_cast<std::size_t>(i)].joint;
}

inline Eigen::Matrix3d about(int axis, double angle) { return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis)).toRotationMatrix(); }
inline double away(const SE3<double>& X, const Eigen::Matrix3d& R) { return (toEigen(X).topLeftCorner<3, 3>() - R).cwiseAbs().maxCoeff(); }

/// The pose of the only body, which the attributes turn.
inline SE3<double> turned(const std::string& attributes, const std::string& before = "") {
  return read("<body name=\"a\" " + attributes + "/>", before).bodies.back().joint.placement;
}

inline bool noted(const Model& model, const std::string& what) {
  return std::any_of(model.notes.begin(), model.notes.end(), [&](const std::string& note) { return note.find(what) != std::string::npos; });
}

inline const std::string mass = "<geom type=\"sphere\" size=\"0.1\"/>";

}  // namespace dyn::test
