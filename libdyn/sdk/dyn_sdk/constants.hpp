// SPDX-License-Identifier: BSD-2-Clause
// A joint's constants as its author's functions see them: c[k], independent of their layout in memory.
#pragma once

#include <cstddef>

namespace dyn::sdk {

/// The constants of one joint: c[k] is constant k. By default these are the numbers of the parameters, in the order of the schema.
class Constants {
 public:
  /// Refers to `count` numbers that are `stride` apart.
  Constants(const double* base, std::ptrdiff_t stride, int count) : base_(base), stride_(stride), count_(count) {}
  double operator[](int k) const { return base_[k * stride_]; }  ///< constant k; k is not checked
  int size() const { return count_; }                            ///< number of constants

 private:
  const double* base_;
  std::ptrdiff_t stride_;
  int count_;
};

/// The constants of neighbouring joints, a pack for each number. Functions that take `const auto& c`, and write S(c[k]) for a number of it, also
/// accept these constants. They are then computed for joints with different parameters at once.
template <class S>
class PackConstants {
 public:
  /// Refers to `count` packs that are `stride` numbers apart.
  PackConstants(const double* base, std::ptrdiff_t stride, int count) : base_(base), stride_(stride), count_(count) {}
  S operator[](int k) const { return S::load(base_ + k * stride_); }  ///< constant k of each joint; k is not checked
  int size() const { return count_; }                                 ///< number of constants of a joint

 private:
  const double* base_;
  std::ptrdiff_t stride_;
  int count_;
};

}  // namespace dyn::sdk
