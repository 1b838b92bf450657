// SPDX-License-Identifier: BSD-2-Clause
// Reads robots and worlds from SDF, by libsdformat. Nothing is printed: warnings become notes, and errors are thrown.
#pragma once

#include <dyn/model/model.hpp>
#include <dyn/parsers/options.hpp>

#include <string>

namespace dyn::sdf {

/// Reads a model or a world with all its models. Every link becomes a body, also of nested models, whose names begin with "MODEL::". A link that no
/// joint carries hangs on the world by a joint of the type `root`; links of static models are fixed there. Joints that would close a loop become
/// constraints, and so do gearboxes. Included files lie in the folder of `path` or below it, unless Files::anywhere is given. Throws Error(file),
/// Error(syntax | model) with the line where libsdformat tells it, and Error(argument) for a root joint that no link needs.
DYN_API Model load(const std::string& path, const LoadOptions& options = {});
/// Does the same for a text, which messages call `name`. Included files are searched in the folder of `name`.
DYN_API Model parse(const std::string& text, const std::string& name, const LoadOptions& options = {});

}  // namespace dyn::sdf
