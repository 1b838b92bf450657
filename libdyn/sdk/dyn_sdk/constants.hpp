// SPDX-License-Identifier: BSD-2-Clause
// A joint's constants as its author's functions see them: c[k], independent of their layout in memory.
#pragma once

#include <cstddef>

namespace dyn::sdk {

class Constants {
 public:
  Constants(const double* base, std::ptrdiff_t stride, int count) : base_(base), stride_(stride), count_(count) {}
  double operator[](int k) const { return base_[k * stride_]; }
  int size() const { return count_; }

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
  PackConstants(const double* base, std::ptrdiff_t stride, int count) : base_(base), stride_(stride), count_(count) {}
  S operator[](int k) const { return S::load(base_ + k * stride_); }
  int size() const { return count_; }

 private:
  const double* base_;
  std::ptrdiff_t stride_;
  int count_;
};

}  // namespace dyn::sdk
