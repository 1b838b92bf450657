// SPDX-License-Identifier: BSD-2-Clause
// Reading and replacing of whole files.
#pragma once

#include <dyn/export.hpp>

#include <cstdint>
#include <limits>
#include <string>

namespace dyn {

/// Returns all bytes of a file or a pipe. Throws Error(file) if it cannot be read, or as soon as more than `largest` bytes have been read.
DYN_API std::string readFile(const std::string& path, std::uintmax_t largest = std::numeric_limits<std::uintmax_t>::max());

/// Replaces a file as a whole: writes a temporary file beside it, flushes that to disk and renames it. If this fails, the old file is unchanged.
/// Follows links; the file keeps its owner and its mode. Writes in place into devices and pipes, and into another user's file that this process may
/// write but not give away. Throws Error(file), also for a file that its mode forbids everybody to write.
DYN_API void replaceFile(const std::string& path, const std::string& content);

/// Throws Error(file) if replaceFile could not create its file; changes nothing. Programs call this before a long computation.
DYN_API void checkReplaceable(const std::string& path);

}  // namespace dyn
