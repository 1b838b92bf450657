// SPDX-License-Identifier: BSD-2-Clause
// Writes numbers in messages with nine digits at most, and with a point whatever the locale.
#pragma once

#include <charconv>
#include <string>

namespace dyn {

inline std::string number(double x) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, x, std::chars_format::general, 9).ptr};
}

}  // namespace dyn
