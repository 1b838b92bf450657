// Packs of neighbouring numbers.
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

}  // namespace dyn
