// SPDX-License-Identifier: BSD-2-Clause
// Polynomials and natural cubic splines as rows of constants: [coordinate, count of knots (0: a polynomial), count of numbers, numbers...].
// A polynomial's numbers are its coefficients; a spline's are x, y and the second derivative at each knot.
#pragma once

#include <dyn_sdk/joint_plugin.hpp>

#include <vector>

namespace function {

inline constexpr int header = 3;

inline int size(int coefficients, int knot_numbers) { return header + coefficients + 3 * (knot_numbers / 2); }

inline bool isKnots(const double* xy, int count) {
  if (count < 4 || count % 2 != 0) return false;
  for (int k = 2; k < count; k += 2)
    if (!(xy[k] > xy[k - 2])) return false;
  return true;
}

/// Second derivatives of the natural spline at its knots: zero at the ends, and between them
/// h_{k-1} m_{k-1} + 2 (h_{k-1} + h_k) m_k + h_k m_{k+1} = 6 (slope_k - slope_{k-1}); de Boor 1978, chapter IV.
inline std::vector<double> curvatures(const double* xy, int knots) {
  const auto n = static_cast<std::size_t>(knots);
  const auto h = [&](std::size_t k) { return xy[2 * k + 2] - xy[2 * k]; };
  const auto slope = [&](std::size_t k) { return (xy[2 * k + 3] - xy[2 * k + 1]) / h(k); };
  std::vector<double> m(n, 0.0), upper(n, 0.0);
  for (std::size_t k = 1; k + 1 < n; ++k) {
    const double pivot = 2 * (h(k - 1) + h(k)) - h(k - 1) * upper[k - 1];
    upper[k] = h(k) / pivot;
    m[k] = (6 * (slope(k) - slope(k - 1)) - h(k - 1) * m[k - 1]) / pivot;
  }
  for (std::size_t k = n - 1; k-- > 1;) m[k] -= upper[k] * m[k + 1];
  return m;
}

/// Writes one function's row; returns where the next one starts.
inline double* write(double coordinate, const double* coefficients, int coefficient_count, const double* xy, int knot_numbers, double* out) {
  const int knots = knot_numbers / 2;
  *out++ = coordinate;
  *out++ = knots;
  *out++ = coefficient_count + 3 * knots;
  for (int k = 0; k < coefficient_count; ++k) *out++ = coefficients[k];
  if (knots == 0) return out;
  const std::vector<double> m = curvatures(xy, knots);
  for (int k = 0; k < knots; ++k) {
    *out++ = xy[2 * k];
    *out++ = xy[2 * k + 1];
    *out++ = m[static_cast<std::size_t>(k)];
  }
  return out;
}

template <class S>
S polynomial(const S& x, const dyn::sdk::Constants& c, int at, int count) {
  S sum(0);
  for (int k = count; k-- > 0;) sum = sum * x + S(c[at + k]);
  return sum;
}

template <class S>
S spline(const S& x, const dyn::sdk::Constants& c, int at, int knots) {
  const double value = dyn::valueOf(x);
  int k = 0;
  while (k + 2 < knots && value > c[at + 3 * (k + 1)]) ++k;
  const int left = at + 3 * k, right = left + 3;
  const double h = c[right] - c[left], slope = (c[right + 1] - c[left + 1]) / h;
  // Beyond the ends the second derivative is zero, as it is at the ends: the spline goes on as a line with the slope that it ends with.
  if (value < c[left]) return S(c[left + 1]) + S(slope - h / 6 * (2 * c[left + 2] + c[right + 2])) * (x - S(c[left]));
  if (value > c[right]) return S(c[right + 1]) + S(slope + h / 6 * (c[left + 2] + 2 * c[right + 2])) * (x - S(c[right]));
  const S b = (x - S(c[left])) / S(h), a = S(1) - b;
  return a * S(c[left + 1]) + b * S(c[right + 1]) + (S(h * h / 6 * c[left + 2]) * (a * a * a - a) + S(h * h / 6 * c[right + 2]) * (b * b * b - b));
}

/// Evaluates the function whose row starts at `at`, and moves `at` to the next row.
template <class S>
S evaluate(const S* q, const dyn::sdk::Constants& c, int& at) {
  const S& x = q[static_cast<int>(c[at])];
  const int knots = static_cast<int>(c[at + 1]), count = static_cast<int>(c[at + 2]), first = at + header;
  at = first + count;
  return knots > 0 ? spline(x, c, first, knots) : polynomial(x, c, first, count);
}

}  // namespace function
