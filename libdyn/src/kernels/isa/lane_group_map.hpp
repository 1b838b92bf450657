// SPDX-License-Identifier: BSD-2-Clause
// The centroidal momentum map over lane groups.
#pragma once

#include "kernels/order/root_paths.hpp"
#include "kernels/recursion/centroidal_map.hpp"

namespace dyn::kernels {

/// Has the interface of BodyMap. Trees are in lanes, and each lane writes its joint's columns as six consecutive numbers.
template <class S>
struct LaneGroupMap {
  const CompactImpl& m;
  double* map;

  Motion<S> ofFirst(const Motion<S>* array) const {
    const LaneSlot& lane_slot = m.lane_groups.lane_slots[1];
    return inAllLanes<S>(array[lane_slot.group], lane_slot.lane);
  }
  /// Returns x with zeros in lanes that have no body or a mirrored body.
  template <class T>
  T own(int i, const T& x) const {
    const auto mine = lanes<S>(m.lane_groups.lane_groups[static_cast<std::size_t>(i)].bodies);
    T out;
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = select(mine, packsOf<S>(x)[k], S(0));
    return out;
  }
  template <class T>
  T sum(const T& x) const {
    T out;
    for (std::size_t k = 0; k < packs_in<S, T>; ++k) packsOf<S>(out)[k] = sumInAll(packsOf<S>(x)[k]);
    return out;
  }
  void put(int i, int, int k, const Force<S>& f) const {
    const auto here = RootPaths<S>(m, i).here();
    putSixes(here, f, [&](int lane) { return map + 6 * here.dof(lane, k); });
  }
  /// Handles one tree after the other: most models have a single tree, for which four lanes would repeat the same work.
  void putFloatingBase(int i, int, const WholeTree<S>& tree, const Mat3<S>& R) const {
    const auto here = RootPaths<S>(m, i).here();
    inEnteringLanes(here, [&](int lane) {
      const auto one = fromLane<WholeTree<double>, S>(tree, lane);
      const WholeTree<Vectored> whole{one.mass, cast<Vectored>(one.h), cast<Vectored>(one.I), cast<Vectored>(one.place)};
      auto* to = reinterpret_cast<Vectored*>(map + 6 * here.dof(lane, 0));
      floatingBaseColumns(whole, cast<Vectored>(fromLane<Mat3<double>, S>(R, lane)), [&](int k, const Force<Vectored>& f) { putSix(f, to + 6 * k); });
    });
  }
};

}  // namespace dyn::kernels
