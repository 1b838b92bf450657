// SPDX-License-Identifier: BSD-2-Clause
// Loops over rows of constraints in packs, one pack or several packs at a time. T is the type of a row's number: double, or a pack of states; packs
// of states have one row each.
#pragma once

#include "kernels/pack/columns.hpp"
#include "kernels/pack/neighbours.hpp"

#include <type_traits>
#include <utility>

namespace dyn::kernels {

/// How many rows a pack P has.
template <class P, class T>
inline constexpr int rows_of = lanes_of<P> / lanes_of<T>;

/// Calls use(first, P) for the rows in [begin, end), in packs P. P is Wide, and Half at the end if the remaining rows fit into Half.
template <class Wide, class Half, class T = double, class Use>
void inPacks(int begin, int end, Use&& use) {
  while (end - begin > rows_of<Half, T>) {
    use(begin, std::type_identity<Wide>());
    begin += rows_of<Wide, T>;
  }
  if (begin < end) use(begin, std::type_identity<Half>());
}

/// The same in groups of packs: calls use(first, P, packs), where `packs` is a constant. A core computes several packs of a group at once.
template <class Wide, class Half, class T = double, class Use>
void inGroups(int begin, int end, Use&& use) {
  constexpr int most = 3, narrow = rows_of<Half, T>;
  while (end - begin > most * narrow) {
    use(begin, std::type_identity<Wide>(), std::integral_constant<int, 2>());
    begin += 2 * rows_of<Wide, T>;
  }
  // Measured: through withConstant() compilers keep groups in memory, and constraintDynamics takes 8 % longer.
  if (end - begin > 2 * narrow) return use(begin, std::type_identity<Half>(), std::integral_constant<int, 3>());
  if (end - begin > narrow) return use(begin, std::type_identity<Half>(), std::integral_constant<int, 2>());
  if (end > begin) use(begin, std::type_identity<Half>(), std::integral_constant<int, 1>());
}

/// Stores the first `count` numbers of a pack, or all if there are fewer.
template <class P, class T>
void storeFirst(const P& value, int count, T* to) {
  if constexpr (rows_of<P, T> == 1) {
    if (count > 0) *to = value;
  } else {
    storeFirst<lanes_of<P>>(static_cast<typename Square<double, lanes_of<P>>::Row>(value.x), count, to);
  }
}

}  // namespace dyn::kernels
