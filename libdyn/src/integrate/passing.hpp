// SPDX-License-Identifier: BSD-2-Clause
// Finds where a function of the state passes zero within a step, also if its signs at the step's ends are equal.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace dyn {

/// A step is sampled ("looked at") at its two ends and at equal fractions between them: looks + 1 samples.
inline constexpr int looks = 6;
using Looks = std::array<double, looks + 1>;

inline double shareOf(int look) { return static_cast<double>(look) / looks; }

/// Returns the smallest fraction of a step, to 2^-45, at which g is negative; infinity if there is none. `at` holds the samples g(shareOf(k)); the
/// first is not negative. If a parabola through three samples tells that g comes near to zero between two of them, a golden-section search follows.
template <class G>
double firstNegative(const Looks& at, G&& g) {
  constexpr double resolution = 0x1p-45, infinity = std::numeric_limits<double>::infinity();
  const auto passing = [&](double low, double high) {
    while (high - low > resolution) {
      const double middle = 0.5 * (low + high);
      (g(middle) < 0 ? high : low) = middle;
    }
    return high;
  };
  for (std::size_t k = 1; k < at.size(); ++k) {
    const double left = shareOf(static_cast<int>(k) - 1), right = shareOf(static_cast<int>(k));
    if (at[k] < 0) return passing(left, right);
    // True if a parabola has a dip between these two samples. It goes through them and the next sample, or the one before.
    const auto dips = [&](std::size_t first) {
      const double slope = 0.5 * (at[first + 2] - at[first]), curvature = at[first + 2] - 2 * at[first + 1] + at[first];
      if (!(curvature > 0)) return false;
      const double lowest = static_cast<double>(first + 1) - slope / curvature;
      const double value = at[first + 1] - 0.5 * slope * slope / curvature;
      return lowest > static_cast<double>(k) - 1.25 && lowest < static_cast<double>(k) + 0.25 && value < 0.5 * std::min(at[k - 1], at[k]);
    };
    if (!((k + 1 < at.size() && dips(k - 1)) || (k >= 2 && dips(k - 2)))) continue;
    constexpr double golden = 0.6180339887498949;
    double low = left, high = right, a = high - golden * (high - low), b = low + golden * (high - low), at_a = g(a), at_b = g(b);
    while (high - low > 0x1p-30) {
      if (at_a < 0 || at_b < 0) return passing(left, at_a < 0 ? a : b);
      if (at_a < at_b) {
        high = b;
        b = a, at_b = at_a;
        a = high - golden * (high - low), at_a = g(a);
      } else {
        low = a;
        a = b, at_a = at_b;
        b = low + golden * (high - low), at_b = g(b);
      }
    }
  }
  return infinity;
}

}  // namespace dyn
