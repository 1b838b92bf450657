// SPDX-License-Identifier: BSD-2-Clause
// Packs of neighbouring numbers.
#pragma once

#include <dyn/scalar/select.hpp>

#include <type_traits>

namespace dyn {

/// Loads neighbouring numbers into a pack: as many as Wide has lanes, or one where S has as many lanes itself.
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

/// How many neighbouring numbers go into one pack. Scalars other than double are taken one by one, because packs have their own use of lanes.
template <class S>
inline constexpr int pack_width = std::is_same_v<S, double> ? 8 : 1;

}  // namespace dyn
