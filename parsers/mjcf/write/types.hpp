// SPDX-License-Identifier: BSD-2-Clause
// Joint types of libdyn that are made of MuJoCo's, and their parameters.
#pragma once

#include <dyn/model/joint_description.hpp>

#include <string>
#include <vector>

namespace dyn::mjcf {

/// The neutral coordinates of a type, and its number of degrees of freedom.
struct Space {
  const char* type;
  std::vector<double> neutral;
  std::size_t nv;
};

/// Throws Error(model) that says why a joint cannot be written.
[[noreturn]] void refuse(const JointDescription& joint, const std::string& why);
/// Returns the space of a joint without parts. Throws Error(model) for a type that no joints of MuJoCo are equal to.
const Space& spaceOf(const JointDescription& joint);
/// Returns the parts of a composite joint. Throws Error(model) if it has none.
const std::vector<JointDescription>& partsOf(const JointDescription& joint);
/// Return a parameter of three numbers, and the pitch of a helical joint. Throw Error(model) if it is missing.
/// @{
Vec3<double> vectorIn(const JointDescription& joint, const char* name);
double pitchOf(const JointDescription& joint);
/// @}
/// Returns the axes x, y and z of a planar joint, as columns. Throws Error(model) if its axis has no direction.
Mat3<double> planeOf(const JointDescription& joint);

}  // namespace dyn::mjcf
