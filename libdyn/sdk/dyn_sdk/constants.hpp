// A joint's constants as its author sees them: c[k], wherever they lie.
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

/// The constants of neighbouring joints, a pack for each number. An author whose functions take `const auto& c`, and say S(c[k]) where a
/// number of theirs is meant, gets these, too, and is computed for joints of different parameters at once.
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
