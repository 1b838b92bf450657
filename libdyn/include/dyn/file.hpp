// Files that are read or written whole or not at all.
#pragma once

#include <dyn/export.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace dyn {

/// All bytes of a file, or of a pipe. Throws Error(file), for more than `largest` bytes, too, of which no more are read.
DYN_API std::string readFile(const std::string& path, std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// Writes a temporary beside the file, brings it to the disk and renames it; what was there before stays if that fails. Links are followed, and the
/// file keeps its owner and its modes. Devices and pipes are written into, as is a file of another user that this process may write but not give
/// away. Throws Error(file), for a file that nobody may write, too.
DYN_API void replaceFile(const std::string& path, const std::string& content);

/// Throws Error(file) where replaceFile could make no file, and leaves everything as it was: for programs that work long before they write.
DYN_API void checkReplaceable(const std::string& path);

}  // namespace dyn
