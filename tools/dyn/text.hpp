// SPDX-License-Identifier: BSD-2-Clause
// Texts for other programs.
#pragma once

#include <string>

namespace dyn::tool {

/// The text with each `mark` replaced.
inline std::string replaced(std::string text, const std::string& mark, const std::string& by) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + by.size())) text.replace(at, mark.size(), by);
  return text;
}

/// A word of a POSIX shell.
inline std::string shellWord(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

}  // namespace dyn::tool
