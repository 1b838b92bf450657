// SPDX-License-Identifier: BSD-2-Clause
// The floating-point environment: a shared object that was linked with -ffast-math sets it for the whole thread that loads it.
#pragma once

#include <cfenv>

namespace dyn {

/// Saves the environment and restores it in its destructor: the rounding mode, and whether subnormal numbers are flushed to zero.
class FloatingPointEnvironment {
 public:
  FloatingPointEnvironment() { std::fegetenv(&kept_); }
  ~FloatingPointEnvironment() { std::fesetenv(&kept_); }
  FloatingPointEnvironment(const FloatingPointEnvironment&) = delete;
  FloatingPointEnvironment& operator=(const FloatingPointEnvironment&) = delete;

 private:
  std::fenv_t kept_;
};

/// Whether subnormal results are kept, and not flushed to zero.
inline bool keepsSmallNumbers() {
  volatile double smallest = 0x1p-1022, half = 0.5;
  return smallest * half != 0;
}

}  // namespace dyn
