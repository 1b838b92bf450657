// SPDX-License-Identifier: BSD-2-Clause
// The URDF writer's output: poses as xyz and rpy, and the parts of <joint> and <libdyn>.
#pragma once

#include "xml/output.hpp"

#include <dyn/model/model.hpp>

#include <string>

namespace dyn::urdf {

struct Output : xml::Output {
  Output() : xml::Output("URDF") {}
  /// Writes the attributes of a pose, as far as they are not zero.
  void putPose(const SE3<double>& X, const char* xyz = "xyz", const char* rpy = "rpy");
  /// Writes <origin>, unless the pose is the identity.
  void origin(const SE3<double>& X);
};

/// Writes <joint>, which connects two links.
void writeJoint(Output& out, const JointDescription& joint, const std::string& parent, const std::string& child, bool master_is_joint);
/// Whether the joint needs an element in <libdyn>, too.
bool needsExtension(const JointDescription& joint, bool master_is_joint);
/// Writes that element: its type, parameters and parts, and the values for which <joint> has no place.
void writeExtension(Output& out, const JointDescription& joint, bool master_is_joint);
/// Writes values as attributes; texts that would read back as numbers are lost.
void writeParameters(Output& out, const Parameters& parameters, const std::string& owner);

}  // namespace dyn::urdf
