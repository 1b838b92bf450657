// SPDX-License-Identifier: BSD-2-Clause
// Descriptions in Python: lists of bodies are views of the model's own lists.
#pragma once

#include "registry.hpp"

#include <dyn/compile/edit.hpp>
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

/// Parameters as Python writes them: a number stands for a list of one.
using GivenParameters = std::map<std::string, std::variant<double, std::vector<double>, std::string, std::vector<JointDescription>>>;
Parameters parametersOf(const GivenParameters& given);

/// Returns the index of a body that is given by name or index. Throws Error(argument) for an unknown name.
int bodyOf(const Model& model, const std::variant<int, std::string>& body);

std::vector<LockedJoint> lockedJoints(const Locks& lock);

}  // namespace dyn::python
