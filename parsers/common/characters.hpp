// SPDX-License-Identifier: BSD-2-Clause
// Characters of texts from files: UTF-8, and what a terminal would obey.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace dyn {

/// XML allows three characters below the space: tab and the two that end lines (XML 1.0, sec. 2.2).
inline bool isControl(unsigned long c) { return c < 0x20 && c != '\t' && c != '\n' && c != '\r'; }

/// Returns the length in bytes of the UTF-8 character at `i`; 0 if there is none (RFC 3629: the shortest form, no surrogates, up to 10FFFF).
inline std::size_t characterAt(std::string_view text, std::size_t i) {
  const auto byte = [&](std::size_t k) { return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0u; };
  const unsigned lead = byte(0), second = byte(1);
  if (lead < 0x80) return 1;
  const std::size_t length = lead >= 0xc2 && lead < 0xe0 ? 2 : (lead >= 0xe0 && lead < 0xf0 ? 3 : (lead >= 0xf0 && lead < 0xf5 ? 4 : 0));
  if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second >= 0xa0) || (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second >= 0x90))
    return 0;
  for (std::size_t k = 1; k < length; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  return length;
}

/// Whether a text is UTF-8 without control characters.
inline bool isPlainText(std::string_view text) {
  for (std::size_t i = 0, length = 1; i < text.size(); i += length) {
    length = characterAt(text, i);
    if (length == 0 || isControl(static_cast<unsigned char>(text[i])) || text[i] == 0x7f) return false;
  }
  return true;
}

/// Returns a text for messages: every byte that is no plain text is a question mark.
inline std::string printable(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = characterAt(text, i);
    const bool plain = length > 0 && static_cast<unsigned char>(text[i]) >= 0x20 && text[i] != 0x7f;
    out += plain ? std::string(text.substr(i, length)) : "?";
    i += plain ? length : 1;
  }
  return out;
}

}  // namespace dyn
