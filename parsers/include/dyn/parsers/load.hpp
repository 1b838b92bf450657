// SPDX-License-Identifier: BSD-2-Clause
// One door to all formats of model files.
#pragma once

#include <dyn/parsers/json.hpp>
#include <dyn/parsers/urdf.hpp>

namespace dyn {

/// The format of a model file; by_name decides by the file's ending: .json is libdyn's own format, all others are URDF.
enum class ModelFormat { by_name, urdf, json };

/// Reads a robot from a file. Throws Error(file | syntax | model) as the format's own function, Error(syntax) with the command to run for a .xacro
/// file, and Error(argument) for a root joint if the format has one already.
DYN_API Model load(const std::string& path, const LoadOptions& options = {}, ModelFormat format = ModelFormat::by_name);

}  // namespace dyn
