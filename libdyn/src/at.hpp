// SPDX-License-Identifier: BSD-2-Clause
// Indices are int, as in the equations; containers take std::size_t.
#pragma once

#include <cstddef>

namespace dyn {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace dyn
