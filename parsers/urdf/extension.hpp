// SPDX-License-Identifier: BSD-2-Clause
// Extensions to URDF, under <robot>: <libdyn> <joint name="..." type="..." parameter="..."/> <loop .../> </libdyn>.
#pragma once

#include "validate.hpp"

#include <dyn/model/model.hpp>

#include <unordered_map>

namespace dyn::urdf {

/// The extension's element for each joint, by name. Values that consist of numbers become numbers, others texts; <part> children become the list
/// "parts"; a <coupling> child makes the joint depend on another. Throws Error(model) for unknown elements and for joints that the robot does not
/// have or that are described twice.
using Extensions = std::unordered_map<std::string, const tinyxml2::XMLElement*>;
Extensions readExtensions(const Document& document, const Outline& outline);

/// Replaces type and parameters of `joint` by those of the extension. Keeps its name, its placement, and the limits, armature, damping, friction and
/// coupling that the extension does not give.
void applyExtension(const Document& document, const tinyxml2::XMLElement& extension, JointDescription& joint);

/// Reads the closed loops, <loop name link other free="rz" .../>, and gears, <gear joint type master .../>, of all <libdyn> elements. Throws
/// Error(model) for links and joints that the robot does not have.
std::vector<ConstraintDescription> readConstraints(const Document& document, const Outline& outline);

/// Returns the pose of an <origin>: xyz and R = Rz(y) Ry(p) Rx(r) of rpy, or quat_xyzw in place of rpy. R is rounded once.
SE3<double> poseOf(const Document& document, const tinyxml2::XMLElement& e);

}  // namespace dyn::urdf
