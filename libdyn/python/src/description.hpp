// SPDX-License-Identifier: BSD-2-Clause
// Descriptions in Python: lists of bodies are views of the model's own lists.
#pragma once

#include "module.hpp"

#include <dyn/compile/edit.hpp>
#include <dyn/joint/registry.hpp>
#include <dyn/model/model.hpp>

#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

PYBIND11_MAKE_OPAQUE(std::vector<dyn::BodyDescription>)
PYBIND11_MAKE_OPAQUE(std::vector<dyn::FrameDescription>)

namespace dyn::python {

/// Returns the standard registry, which all calls share.
const JointRegistry& registry();

/// Returns the index of a body that is given by name or index. Throws Error(argument) for an unknown name.
int bodyOf(const Model& model, const std::variant<int, std::string>& body);

/// Returns the joints to hold: names with coordinates, one number or several, or nothing for neutral.
std::vector<LockedJoint> lockedJoints(const std::map<std::string, std::optional<std::variant<double, std::vector<double>>>>& lock);

}  // namespace dyn::python
