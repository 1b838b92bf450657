// SPDX-License-Identifier: BSD-2-Clause
// SHA-256 (FIPS 180-4), by which results are compared and damaged files are found.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace dyn::tool::sweep {

class Sha256 {
 public:
  void add(std::string_view bytes);
  /// Returns the digest of all bytes so far as 64 hexadecimal digits. Nothing can be added after it.
  std::string digest();

 private:
  void block(const unsigned char* bytes);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::array<unsigned char, 64> pending_{};
  std::size_t count_ = 0;  ///< bytes in `pending_`
  std::uint64_t total_ = 0;
};

/// The digest of a text.
std::string sha256(std::string_view text);

}  // namespace dyn::tool::sweep
