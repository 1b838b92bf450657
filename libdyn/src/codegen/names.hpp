// SPDX-License-Identifier: BSD-2-Clause
// Checks whether functions can be written as C.
#pragma once

#include <dyn/codegen/source.hpp>

#include <vector>

namespace dyn {

/// Throws Error(argument) if the name of a function or argument is not a C identifier, occurs twice, or is used by the generated code itself, and for
/// invalid numbers of lanes or of operations per piece.
void checkSource(const std::vector<TracedFunction>& functions, const SourceOptions& options);

}  // namespace dyn
