// SPDX-License-Identifier: BSD-2-Clause
// A digest tells one text from another, and a whole text from one that was changed or cut short by accident. It does not protect against forgery.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace dyn {

/// 64-bit FNV-1a hash (Fowler, Noll, Vo), whose upper bits are mixed into the lower ones at the end.
constexpr std::uint64_t fnv(std::string_view text, std::uint64_t h) {
  for (const char c : text) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
  return h ^ (h >> 31);
}

/// Returns two hashes of the text, each as sixteen hexadecimal digits.
inline std::string digest(std::string_view text) {
  std::string out;
  for (const std::uint64_t start : {std::uint64_t(14695981039346656037u), std::uint64_t(0x9e3779b97f4a7c15u)}) {
    const std::uint64_t hash = fnv(text, start);
    for (int digit = 15; digit >= 0; --digit) out += "0123456789abcdef"[hash >> (4 * digit) & 15];
  }
  return out;
}

}  // namespace dyn
