// What URDF has no words for, under <robot>: <libdyn> <joint name="..." type="..." parameter="..."/> <loop .../> </libdyn>.
#pragma once

#include "validate.hpp"

#include <dyn/model/model.hpp>

#include <unordered_map>

namespace dyn::urdf {

/// What the extension says of each joint, by name. Values made of numbers become numbers, others texts; <part> children become the
/// list "parts"; a <coupling> child makes the joint follow another. Throws Error for joints that the robot does not have.
using Extensions = std::unordered_map<std::string, const tinyxml2::XMLElement*>;
Extensions readExtensions(const Document& document, const Outline& outline);

/// Replaces type and parameters of `joint` by what the extension says; keeps its placement.
void applyExtension(const Document& document, const tinyxml2::XMLElement& extension, JointDescription& joint);

/// The closed loops, <loop name frame other free="rz" .../>, and gears, <gear joint type master .../>, of all <libdyn> elements. Throws Error for
/// links and joints that the robot does not have.
std::vector<ConstraintDescription> readConstraints(const Document& document, const Outline& outline);

/// Pose of an <origin xyz rpy>, or of xyz and rpy attributes: R = Rz(y) Ry(p) Rx(r), rounded once.
SE3<double> poseOf(const Document& document, const tinyxml2::XMLElement& e);

}  // namespace dyn::urdf
