// SPDX-License-Identifier: BSD-2-Clause
// Numbers are the same if their bits are: 0 and -0 differ here, and a NaN equals itself.
#pragma once

#include <cstring>
#include <type_traits>

namespace dyn {

/// For types of numbers only, without padding between them.
template <class T>
bool sameBits(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::memcmp(&a, &b, sizeof a) == 0;  // NOLINT: bits are meant
}

}  // namespace dyn
