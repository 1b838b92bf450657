// SPDX-License-Identifier: BSD-2-Clause
// Gragg's extrapolation: midpoint rules with 2, 4, ... steps, whose error terms in powers of h^2 are eliminated (Hairer, Norsett and Wanner 1993,
// sec. II.9). It is for references and shares nothing with the library's integrators.
#pragma once

#include <array>
#include <cstddef>

namespace dyn::tool {

/// y after one step of h along dy/dt = rate(y). The method has order 2 `columns`. Scalar is the type of the vector's entries.
template <int columns, class Vector, class Scalar, class Rate>
Vector extrapolate(const Vector& y, const Scalar& h, Rate&& rate) {
  std::array<std::array<Vector, columns>, columns> T;
  const Vector first = rate(y);
  for (int j = 0; j < columns; ++j) {
    const int n = 2 * (j + 1);
    const Scalar part = h / Scalar(n);
    Vector before = y, now = y + part * first;
    for (int k = 1; k < n; ++k) {
      const Vector next = before + Scalar(2) * part * rate(now);
      before = now;
      now = next;
    }
    auto& row = T[static_cast<std::size_t>(j)];
    row[0] = (now + before + part * rate(now)) / Scalar(2);
    for (int l = 1; l <= j; ++l) {
      const Scalar ratio = Scalar((j + 1) * (j + 1)) / Scalar((j - l + 1) * (j - l + 1));
      const auto L = static_cast<std::size_t>(l);
      row[L] = row[L - 1] + (row[L - 1] - T[static_cast<std::size_t>(j - 1)][L - 1]) / (ratio - Scalar(1));
    }
  }
  return T[columns - 1][columns - 1];
}

}  // namespace dyn::tool
