// SPDX-License-Identifier: BSD-2-Clause
// Numbers that are processed in place. In packs of states, a body has more numbers than there are registers. If compilers cache more than fit, they
// spill numbers to the stack and copy them back and forth.
#pragma once

#include <cstddef>

namespace dyn::kernels {

/// Returns x, and makes compilers forget that they have read or written it before, so that they read it from its own place. In orders of single
/// states or lane groups the next body waits for the last results, so there compilers may cache x.
template <class Order, class T>
T& readAgain(const Order&, T& x) {
  T* p = &x;
  if constexpr (Order::lanes_are_states) asm("" : "+r"(p));
  return *p;
}

/// Memory for a T that is written part by part. T{} would first write zeros.
template <class T>
class Unwritten {
 public:
  T& operator*() { return *reinterpret_cast<T*>(bytes_); }

 private:
  alignas(T) std::byte bytes_[sizeof(T)];
};

}  // namespace dyn::kernels
