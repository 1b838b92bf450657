// SPDX-License-Identifier: BSD-2-Clause
// Where a file lies, whatever links and ".." its name has.
#pragma once

#include <filesystem>

namespace dyn::reader {

/// Returns a path without links and "..", also if its last parts do not exist.
inline std::filesystem::path resolvedPath(const std::filesystem::path& path) {
  std::error_code error;
  const std::filesystem::path out = std::filesystem::weakly_canonical(path, error);
  return error ? std::filesystem::absolute(path).lexically_normal() : out;
}

/// Whether a path lies in a folder, which is resolved, or below it.
inline bool isInside(const std::filesystem::path& path, const std::filesystem::path& folder) {
  const std::filesystem::path inside = resolvedPath(path).lexically_relative(folder);
  return !inside.empty() && *inside.begin() != "..";
}

}  // namespace dyn::reader
