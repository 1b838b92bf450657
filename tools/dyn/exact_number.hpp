// SPDX-License-Identifier: BSD-2-Clause
// Numbers with fifty and with a hundred decimal digits, for references. Their operations are compiled once, in exact_number.cpp: Boost's templates
// would cost the compiler a gigabyte and twenty seconds in every source that uses them.
#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <string>

namespace dyn::tool {

/// A number with 50 or 100 decimal digits.
template <int digits>
class ExactNumber {
 public:
  ExactNumber();
  ExactNumber(double x);  // NOLINT(google-explicit-constructor): constants of formulas are doubles
  ExactNumber(const ExactNumber& x);
  ExactNumber& operator=(const ExactNumber& x);
  ~ExactNumber();

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
  /// Negative, zero or positive where a is less than, equal to or greater than b.
  static int compare(const ExactNumber& a, const ExactNumber& b);
  static ExactNumber squareRoot(const ExactNumber& x);
  static ExactNumber sine(const ExactNumber& x);
  static ExactNumber cosine(const ExactNumber& x);
  static ExactNumber arcTangent(const ExactNumber& y, const ExactNumber& x);

  friend ExactNumber operator+(ExactNumber a, const ExactNumber& b) { return a += b; }
  friend ExactNumber operator-(ExactNumber a, const ExactNumber& b) { return a -= b; }
  friend ExactNumber operator*(ExactNumber a, const ExactNumber& b) { return a *= b; }
  friend ExactNumber operator/(ExactNumber a, const ExactNumber& b) { return a /= b; }
  friend bool operator==(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) == 0; }
  friend bool operator!=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) != 0; }
  friend bool operator<(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) < 0; }
  friend bool operator>(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) > 0; }
  friend bool operator<=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) <= 0; }
  friend bool operator>=(const ExactNumber& a, const ExactNumber& b) { return compare(a, b) >= 0; }
  friend ExactNumber abs(const ExactNumber& x) { return x < ExactNumber() ? -x : x; }
  friend ExactNumber sqrt(const ExactNumber& x) { return squareRoot(x); }
  friend ExactNumber sin(const ExactNumber& x) { return sine(x); }
  friend ExactNumber cos(const ExactNumber& x) { return cosine(x); }
  friend ExactNumber atan2(const ExactNumber& y, const ExactNumber& x) { return arcTangent(y, x); }

 private:
  static constexpr std::size_t size = digits == 50 ? 64 : 80;
  alignas(16) std::byte room_[size];  ///< memory of Boost's number
};

}  // namespace dyn::tool

template <int digits>
struct Eigen::NumTraits<dyn::tool::ExactNumber<digits>> : Eigen::GenericNumTraits<dyn::tool::ExactNumber<digits>> {
  using Number = dyn::tool::ExactNumber<digits>;
  enum { IsComplex = 0, IsInteger = 0, IsSigned = 1, RequireInitialization = 1, ReadCost = 10, AddCost = 50, MulCost = 200 };
  static Number epsilon() { return digits == 50 ? Number(1e-50) : Number(1e-100); }
  static Number dummy_precision() { return Number(1000) * epsilon(); }
  static int digits10() { return digits; }
};
