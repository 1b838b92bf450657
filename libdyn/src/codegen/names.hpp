// Which functions can be written as C.
#pragma once

#include <dyn/codegen/source.hpp>

#include <vector>

namespace dyn {

/// Throws Error(argument) for names of functions and arguments that C does not allow, that are there twice, or that the code has for itself, and
/// for lanes and pieces that cannot be.
void checkSource(const std::vector<TracedFunction>& functions, const SourceOptions& options);

}  // namespace dyn
