// Files that are there whole or not at all.
#pragma once

#include <dyn/export.hpp>

#include <string>

namespace dyn {

/// Writes a temporary beside `path` and renames it; what was there before stays if that fails. Throws Error(file).
DYN_API void replaceFile(const std::string& path, const std::string& content);

}  // namespace dyn
