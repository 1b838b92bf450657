// SPDX-License-Identifier: BSD-2-Clause
// Joints and frames that are given by name or number.
#pragma once

#include "module.hpp"

#include <dyn/compile/compact_model.hpp>

#include <pybind11/stl.h>

#include <string>
#include <variant>

namespace dyn::python {

using Name = std::variant<int, std::string>;

inline int jointOf(const CompactModel& model, const Name& joint) {
  return std::holds_alternative<int>(joint) ? std::get<int>(joint) : model.jointId(std::get<std::string>(joint));
}
inline int frameOf(const CompactModel& model, const Name& frame) {
  return std::holds_alternative<int>(frame) ? std::get<int>(frame) : model.frameId(std::get<std::string>(frame));
}

}  // namespace dyn::python
