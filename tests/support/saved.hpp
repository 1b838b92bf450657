// SPDX-License-Identifier: BSD-2-Clause
// Helpers to change saved simulations and give them a valid check sum again.
#pragma once

#include <cstdint>
#include <cstdio>
#include <string>

namespace dyn::test {

/// bodyOf() returns a saved simulation without its last line. sealed() appends a last line with the check sum.
inline std::string bodyOf(const std::string& saved) { return saved.substr(0, saved.rfind("end ")); }
inline std::string sealed(const std::string& body) {
  std::string out = body + "end ";
  for (std::uint64_t h : {std::uint64_t(14695981039346656037u), std::uint64_t(0x9e3779b97f4a7c15u)}) {
    for (const char c : body) h = (h ^ static_cast<unsigned char>(c)) * 1099511628211u;
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(h ^ (h >> 31)));
    out += digits;
  }
  return out + "\n";
}

}  // namespace dyn::test
