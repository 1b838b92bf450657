// The floating-point environment: a shared object that was linked with -ffast-math sets it for the whole thread that loads it.
#pragma once

#include <cfenv>

namespace dyn {

/// Puts back at the end what there was at the beginning: rounding, and whether numbers near zero are flushed to it.
class FloatingPointEnvironment {
 public:
  FloatingPointEnvironment() { std::fegetenv(&kept_); }
  ~FloatingPointEnvironment() { std::fesetenv(&kept_); }
  FloatingPointEnvironment(const FloatingPointEnvironment&) = delete;
  FloatingPointEnvironment& operator=(const FloatingPointEnvironment&) = delete;

 private:
  std::fenv_t kept_;
};

/// Whether a sum of numbers near zero is one, and not flushed to zero.
inline bool keepsSmallNumbers() {
  volatile double smallest = 0x1p-1022, half = 0.5;
  return smallest * half != 0;
}

}  // namespace dyn
