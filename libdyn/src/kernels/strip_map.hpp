// The centroidal momentum map over strips.
#pragma once

#include "kernels/centroidal_map.hpp"
#include "kernels/strip_way.hpp"

namespace dyn::kernels {

/// BodyMap's like: trees are in lanes, and a joint's columns go from each lane to six numbers that follow one another.
template <class S>
struct StripMap {
  const CompactImpl& m;
  double* map;

  Motion<S> ofFirst(const Motion<S>* array) const {
    const Seat& seat = m.strips.seats[1];
    return inAllLanes<S>(array[seat.strip], seat.lane);
  }
  /// Zero in lanes of nobody, and where bodies are mirrored.
  template <class T>
  T own(int i, const T& x) const {
    const auto mine = lanes<S>(m.strips.strips[static_cast<std::size_t>(i)].bodies);
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
    const auto here = StripWay<S>(m, i).here();
    putSixes(here, f, [&](int lane) { return map + 6 * here.dof(lane, k); });
  }
  /// Tree by tree: of one that is alone, which most are, lanes would do the same four times.
  void putFlying(int i, int, const WholeTree<S>& tree, const Mat3<S>& R) const {
    const auto here = StripWay<S>(m, i).here();
    inEnteringLanes(here, [&](int lane) {
      const auto one = fromLane<WholeTree<double>, S>(tree, lane);
      const WholeTree<Vectored> whole{one.mass, cast<Vectored>(one.h), cast<Vectored>(one.I), cast<Vectored>(one.place)};
      auto* to = reinterpret_cast<Vectored*>(map + 6 * here.dof(lane, 0));
      flyingColumns(whole, cast<Vectored>(fromLane<Mat3<double>, S>(R, lane)), [&](int k, const Force<Vectored>& f) { putSix(f, to + 6 * k); });
    });
  }
};

}  // namespace dyn::kernels
