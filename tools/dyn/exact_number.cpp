// SPDX-License-Identifier: BSD-2-Clause
#include "exact_number.hpp"

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <new>
#include <type_traits>

namespace dyn::tool {

namespace {

template <int digits>
using Value = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<digits>, boost::multiprecision::et_off>;

template <int digits>
Value<digits>& in(ExactNumber<digits>& x) {
  return *std::launder(reinterpret_cast<Value<digits>*>(&x));
}
template <int digits>
const Value<digits>& in(const ExactNumber<digits>& x) {
  return *std::launder(reinterpret_cast<const Value<digits>*>(&x));
}
template <int digits>
ExactNumber<digits> number(const Value<digits>& value) {
  ExactNumber<digits> out;
  in(out) = value;
  return out;
}

}  // namespace

template <int digits>
ExactNumber<digits>::ExactNumber() {
  static_assert(sizeof(Value<digits>) <= size && alignof(Value<digits>) <= 16);
  static_assert(std::is_trivially_destructible_v<Value<digits>>);  // that is, without memory of its own elsewhere
  new (room_) Value<digits>();
}
template <int digits>
ExactNumber<digits>::ExactNumber(double x) {
  new (room_) Value<digits>(x);
}
template <int digits>
ExactNumber<digits>::operator double() const {
  return in(*this).template convert_to<double>();
}
template <int digits>
ExactNumber<digits>::operator long double() const {
  return in(*this).template convert_to<long double>();
}
template <int digits>
std::string ExactNumber<digits>::text(int significant) const {
  return in(*this).str(significant - 1, std::ios_base::scientific);
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::operator-() const {
  return number<digits>(-in(*this));
}
template <int digits>
ExactNumber<digits>& ExactNumber<digits>::operator+=(const ExactNumber& x) {
  in(*this) += in(x);
  return *this;
}
template <int digits>
ExactNumber<digits>& ExactNumber<digits>::operator-=(const ExactNumber& x) {
  in(*this) -= in(x);
  return *this;
}
template <int digits>
ExactNumber<digits>& ExactNumber<digits>::operator*=(const ExactNumber& x) {
  in(*this) *= in(x);
  return *this;
}
template <int digits>
ExactNumber<digits>& ExactNumber<digits>::operator/=(const ExactNumber& x) {
  in(*this) /= in(x);
  return *this;
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::sum(const ExactNumber& a, const ExactNumber& b) {
  return number<digits>(in(a) + in(b));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::difference(const ExactNumber& a, const ExactNumber& b) {
  return number<digits>(in(a)-in(b));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::product(const ExactNumber& a, const ExactNumber& b) {
  return number<digits>(in(a)*in(b));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::quotient(const ExactNumber& a, const ExactNumber& b) {
  return number<digits>(in(a) / in(b));
}
template <int digits>
int ExactNumber<digits>::compare(const ExactNumber& a, const ExactNumber& b) {
  return in(a).compare(in(b));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::absolute(const ExactNumber& x) {
  return number<digits>(abs(in(x)));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::squareRoot(const ExactNumber& x) {
  return number<digits>(sqrt(in(x)));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::sine(const ExactNumber& x) {
  return number<digits>(sin(in(x)));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::cosine(const ExactNumber& x) {
  return number<digits>(cos(in(x)));
}
template <int digits>
ExactNumber<digits> ExactNumber<digits>::arcTangent(const ExactNumber& y, const ExactNumber& x) {
  return number<digits>(atan2(in(y), in(x)));
}

template class ExactNumber<50>;
template class ExactNumber<100>;

}  // namespace dyn::tool
