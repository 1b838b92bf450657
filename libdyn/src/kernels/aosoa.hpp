// Structs of neighbours, number beside number, eight of them at a time ("array of structures of arrays"): where neighbours do the same, each
// of their numbers is one pack.
#pragma once

#include <dyn/scalar/select.hpp>

#include <type_traits>

namespace dyn {

/// Neighbouring numbers, as many as Wide has lanes beside S.
template <class Wide, class S>
Wide loadPack(const S* from) {
  if constexpr (lanes_of<Wide> == lanes_of<S>) {
    return *from;
  } else {
    return Wide::load(from);
  }
}
template <class Wide, class S>
void storePack(const Wide& value, S* to) {
  if constexpr (lanes_of<Wide> == lanes_of<S>) {
    *to = value;
  } else {
    value.store(to);
  }
}

/// How many neighbours' numbers stand abreast; other scalars than double have lanes of their own.
template <class S>
inline constexpr int abreast = std::is_same_v<S, double> ? 8 : 1;

/// Of structs T<S> that consist of numbers S.
template <template <class> class T, class S>
class AoSoA {
 public:
  static constexpr int width = abreast<S>;
  template <class U, class N>
  static constexpr int size = static_cast<int>(sizeof(U) / sizeof(N));
  static constexpr int numbers = size<T<S>, S>;
  /// Numbers that so many structs take.
  static constexpr std::size_t room(std::size_t count) { return (count + width - 1) / width * width * numbers; }

  AoSoA() = default;
  explicit AoSoA(S* first) : first_(first) {}

  /// As many neighbours as Wide has lanes, from i on, a multiple of these.
  template <class Wide>
  T<Wide> get(int i) const {
    return part<T, Wide>(i, 0);
  }
  template <class Wide>
  void put(int i, const T<Wide>& x) const {
    putPart(i, 0, x);
  }
  /// The struct U of their numbers from `component` on.
  template <template <class> class U, class Wide>
  U<Wide> part(int i, int component) const {
    const S* from = place(i) + width * component;
    if constexpr (width == 1) {
      return *reinterpret_cast<const U<S>*>(from);
    } else {
      U<Wide> out;
      auto* to = reinterpret_cast<Wide*>(&out);
#pragma GCC unroll 64
      for (int k = 0; k < size<U<Wide>, Wide>; ++k) to[k] = loadPack<Wide>(from + width * k);
      return out;
    }
  }
  template <template <class> class U, class Wide>
  void putPart(int i, int component, const U<Wide>& x) const {
    S* to = place(i) + width * component;
    if constexpr (width == 1) {
      *reinterpret_cast<U<S>*>(to) = x;
    } else {
      const auto* from = reinterpret_cast<const Wide*>(&x);
#pragma GCC unroll 64
      for (int k = 0; k < size<U<Wide>, Wide>; ++k) storePack(from[k], to + width * k);
    }
  }

 private:
  S* place(int i) const {
    const auto u = static_cast<unsigned>(i);
    return first_ + u / width * width * numbers + u % width;
  }
  S* first_ = nullptr;
};

}  // namespace dyn
