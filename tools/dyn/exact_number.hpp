// SPDX-License-Identifier: BSD-2-Clause
// Numbers with fifty and with a hundred decimal digits, for references. Their operations are compiled once, in exact_number.cpp: Boost's templates
// would cost the compiler a gigabyte and twenty seconds in every source that uses them.
#pragma once

#include <cstddef>
#include <string>

namespace dyn::tool {

/// A number with 50 or 100 decimal digits. Its memory refers to nothing, so its bytes are copied.
template <int digits>
class ExactNumber {
 public:
  ExactNumber();
  ExactNumber(double x);  // NOLINT(google-explicit-constructor): constants of formulas are doubles

  /// Rounded to nearest.
  explicit operator double() const;
  explicit operator long double() const;
  /// In scientific notation with this many digits.
  std::string text(int significant) const;

  ExactNumber operator-() const;
  ExactNumber& operator+=(const ExactNumber& x);
  ExactNumber& operator-=(const ExactNumber& x);
  ExactNumber& operator*=(const ExactNumber& x);
  ExactNumber& operator/=(const ExactNumber& x);
  static ExactNumber sum(const ExactNumber& a, const ExactNumber& b);
  static ExactNumber difference(const ExactNumber& a, const ExactNumber& b);
  static ExactNumber product(const ExactNumber& a, const ExactNumber& b);
  static ExactNumber quotient(const ExactNumber& a, const ExactNumber& b);
  /// Negative, zero or positive where a is less than, equal to or greater than b.
  static int compare(const ExactNumber& a, const ExactNumber& b);
  static ExactNumber absolute(const ExactNumber& x);
  static ExactNumber squareRoot(const ExactNumber& x);
  static ExactNumber sine(const ExactNumber& x);
  static ExactNumber cosine(const ExactNumber& x);
  static ExactNumber arcTangent(const ExactNumber& y, const ExactNumber& x);

  friend ExactNumber operator+(const ExactNumber& a, const ExactNumber& b) { return sum(a, b); }
  friend ExactNumber operator-(const ExactNumber& a, const ExactNumber& b) { return difference(a, b); }
  friend ExactNumber operator*(const ExactNumber& a, const ExactNumber& b) { return product(a, b); }
  friend ExactNumber operator/(const ExactNumber& a, const ExactNumber& b) { return quotient(a, b); }
  friend bool operator==(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) == 0; }
  friend bool operator!=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) != 0; }
  friend bool operator<(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) < 0; }
  friend bool operator>(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) > 0; }
  friend bool operator<=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) <= 0; }
  friend bool operator>=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) >= 0; }
  friend ExactNumber abs(const ExactNumber& x) { return absolute(x); }
  friend ExactNumber sqrt(const ExactNumber& x) { return squareRoot(x); }
  friend ExactNumber sin(const ExactNumber& x) { return sine(x); }
  friend ExactNumber cos(const ExactNumber& x) { return cosine(x); }
  friend ExactNumber atan2(const ExactNumber& y, const ExactNumber& x) { return arcTangent(y, x); }

 private:
  static constexpr std::size_t size = digits == 50 ? 64 : 80;
  alignas(16) std::byte room_[size];  ///< memory of Boost's number
};

extern template class ExactNumber<50>;
extern template class ExactNumber<100>;

}  // namespace dyn::tool
