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

/// Joints to hold, by name: coordinates, one number or several, or nothing for neutral.
using Locks = std::map<std::string, std::optional<std::variant<double, std::vector<double>>>>;

/// Returns the standard registry, which all calls share.
JointRegistry& registry();

/// Returns the index of a body that is given by name or index. Throws Error(argument) for an unknown name.
int bodyOf(const Model& model, const std::variant<int, std::string>& body);

std::vector<LockedJoint> lockedJoints(const Locks& lock);

}  // namespace dyn::python
