// SPDX-License-Identifier: BSD-2-Clause
// Random numbers by counter: each number is a function of seed, sample, quantity and entry, so that it does not depend on who draws it and when.
// Philox 4x32 with ten rounds (Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3", 2011).
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>

namespace dyn::tool::sweep {

using PhiloxCounter = std::array<std::uint32_t, 4>;
using PhiloxKey = std::array<std::uint32_t, 2>;

/// Returns 128 random bits for a counter and a key.
constexpr PhiloxCounter philox(PhiloxCounter x, PhiloxKey key) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53} * x[0], b = std::uint64_t{0xCD9E8D57} * x[2];
    x = {static_cast<std::uint32_t>(b >> 32) ^ x[1] ^ key[0], static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(a >> 32) ^ x[3] ^ key[1],
         static_cast<std::uint32_t>(a)};
    key = {key[0] + 0x9E3779B9, key[1] + 0xBB67AE85};
  }
  return x;
}

/// The numbers of one quantity of one sample.
class RandomNumbers {
 public:
  RandomNumbers(std::uint64_t seed, std::uint64_t sample, std::string_view quantity)
      : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
        sample_{static_cast<std::uint32_t>(sample), static_cast<std::uint32_t>(sample >> 32)} {
    // 32-bit FNV-1a: the quantity's name chooses the stream, so that a new quantity does not change those that were there.
    for (const char c : quantity) stream_ = (stream_ ^ static_cast<unsigned char>(c)) * 16777619u;
  }

  /// 64 random bits.
  std::uint64_t bits(std::uint32_t entry) const { return pair(entry)[0]; }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double uniform(std::uint32_t entry) const { return fraction(pair(entry)[0]); }
  /// Normal with mean 0 and deviation 1 (Box and Muller 1958).
  double normal(std::uint32_t entry) const {
    const auto [a, b] = pair(entry);
    return std::sqrt(-2 * std::log(1 - fraction(a))) * std::cos(2 * std::numbers::pi * fraction(b));
  }

 private:
  static double fraction(std::uint64_t x) { return static_cast<double>(x >> 11) * 0x1p-53; }
  std::array<std::uint64_t, 2> pair(std::uint32_t entry) const {
    const PhiloxCounter x = philox({entry, stream_, sample_[0], sample_[1]}, key_);
    return {x[0] | std::uint64_t{x[1]} << 32, x[2] | std::uint64_t{x[3]} << 32};
  }

  PhiloxKey key_;
  std::array<std::uint32_t, 2> sample_;
  std::uint32_t stream_ = 2166136261u;
};

}  // namespace dyn::tool::sweep
