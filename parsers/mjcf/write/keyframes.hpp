// SPDX-License-Identifier: BSD-2-Clause
// Named states as keyframes.
#pragma once

#include "joints.hpp"

namespace dyn::mjcf {

/// The states of joints by the joints' names.
using States = std::unordered_map<std::string, const JointState*>;
/// Returns the state called qpos0, in which an MJCF puts its bodies; empty if there is none.
States homeOf(const Model& model);
/// Returns the pose in the world at which a free joint starts: that of the state `home`, or else `neutral`.
SE3<long double> startOf(const States& home, const std::string& joint, const SE3<long double>& neutral);

/// Writes <keyframe> with the named states. `order` has the bodies in the file's order. A state qpos0 that the bodies' poses say is left out.
void writeKeyframes(const Model& model, const std::vector<std::size_t>& order, const Joints& joints, const std::vector<JointChain>& chains,
                    xml::Output& out);

}  // namespace dyn::mjcf
