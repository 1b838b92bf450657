// SPDX-License-Identifier: BSD-2-Clause
// The Mersenne twister of 64 bits (Nishimura 2000), whose numbers are those of std::mt19937_64.
//
// Most of the time of a short sequence goes to the state of 312 words that follows from the seed, word after word. Here words are made when they are
// needed, and several generators are seeded side by side, so that the processor need not wait for the products of one chain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace dyn {

class RandomNumbers {
 public:
  /// Seeds `count` generators: generator k with seed + k.
  template <std::size_t count>
  static void seed(std::uint64_t seed, std::array<RandomNumbers, count>& generators) {
    std::array<std::uint64_t, count> last;
    for (std::size_t k = 0; k < count; ++k) {
      generators[k].made_ = ahead + 1;
      generators[k].next_ = 0;
      generators[k].words_[0] = last[k] = seed + k;
    }
    for (std::size_t i = 1; i <= ahead; ++i)
      for (std::size_t k = 0; k < count; ++k) generators[k].words_[i] = last[k] = following(last[k], i);
  }

  std::uint64_t operator()() {
    const std::size_t i = next_, after = i + 1 == size ? 0 : i + 1, far = i + ahead < size ? i + ahead : i + ahead - size;
    if (made_ == far) {
      words_[far] = following(words_[far - 1], far);
      ++made_;
    }
    const std::uint64_t mixed = (words_[i] & ~lower) | (words_[after] & lower);
    std::uint64_t x = words_[i] = words_[far] ^ mixed >> 1 ^ (mixed & 1 ? 0xb5026f5aa96619e9u : 0u);
    next_ = after;
    x ^= x >> 29 & 0x5555555555555555u;
    x ^= x << 17 & 0x71d67fffeda60000u;
    x ^= x << 37 & 0xfff7eee000000000u;
    return x ^ x >> 43;
  }

 private:
  static constexpr std::size_t size = 312, ahead = 156;
  static constexpr std::uint64_t lower = 0x7fffffffu;
  static std::uint64_t following(std::uint64_t word, std::size_t i) { return 6364136223846793005u * (word ^ word >> 62) + i; }

  std::array<std::uint64_t, size> words_;
  std::size_t made_;  ///< words that have been seeded; grows to `size`
  std::size_t next_;
};

}  // namespace dyn
