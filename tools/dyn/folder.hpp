// SPDX-License-Identifier: BSD-2-Clause
// Makes the folders that subcommands write to.
#pragma once

#include <dyn/error.hpp>

#include <filesystem>
#include <string>

namespace dyn::tool {

/// Makes a folder with those above it, unless it exists. Throws Error(file) if it cannot be made.
inline void makeFolder(const std::string& path) {
  std::error_code failed;
  std::filesystem::create_directories(path, failed);
  if (failed) throw Error(ErrorCode::file, "the folder cannot be made: " + failed.message(), {path, 0, ""});
}

}  // namespace dyn::tool
