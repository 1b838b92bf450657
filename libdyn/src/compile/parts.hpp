// SPDX-License-Identifier: BSD-2-Clause
// Joints and their parts, by the names that couplings use for them: "joint", "joint/part".
#pragma once

#include <dyn/model/joint_description.hpp>

namespace dyn {

/// The parts of a joint made of joints; null for any other.
template <class Joint>
auto partsOf(Joint& joint) {
  const auto found = joint.parameters.find("parts");
  return found == joint.parameters.end() ? nullptr : std::get_if<std::vector<JointDescription>>(&found->second);
}

/// The name of part k of the joint called `joint`.
inline std::string partName(const std::string& joint, const JointDescription& part, std::size_t k) {
  return joint + "/" + (part.name.empty() ? std::to_string(k) : part.name);
}

/// Calls visit(joint, name) for a joint, and then in order for each of its parts, which is visited in the same way.
template <class Joint, class Visit>
void visitParts(Joint& joint, const std::string& name, const Visit& visit) {
  visit(joint, name);
  if (auto* parts = partsOf(joint))
    for (std::size_t k = 0; k < parts->size(); ++k) visitParts((*parts)[k], partName(name, (*parts)[k], k), visit);
}

}  // namespace dyn
