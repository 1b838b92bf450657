// Numbers that are worked on where they are. A body has more of them, in packs, than there are registers: what compilers keep of them beyond that
// they write to memory of another place, and move to and fro.
#pragma once

#include <cstddef>

namespace dyn::kernels {

/// x, of which compilers do not know that they have written or read it before: it is read from where it is. Orders of one state or of strips, in
/// which the next body waits for what was just computed, keep what they can.
template <class Order, class T>
T& readAgain(const Order&, T& x) {
  T* p = &x;
  if constexpr (Order::streams) asm("" : "+r"(p));
  return *p;
}

/// Room for a T that is written part by part; T{} would first write zeros.
template <class T>
class Unwritten {
 public:
  T& operator*() { return *reinterpret_cast<T*>(bytes_); }

 private:
  alignas(T) std::byte bytes_[sizeof(T)];
};

}  // namespace dyn::kernels
