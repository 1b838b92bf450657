// Where two convex solids rest on each other: what each turns towards the other, face, side or corner, cut to where both are.
#pragma once

#include "geometry/convex.hpp"

namespace dyn {

/// In the axes of A, of a separation's normal n.
struct TouchingPoint {
  Vec3<double> on_a;
  double gap = 0;  ///< from there along n to B
  int id = 0;      ///< below 64, the same as long as the same corners and sides meet
};

struct Manifold {
  static constexpr int most = 17;
  TouchingPoint points[most];
  int count = 0;

  void add(const TouchingPoint& p) {
    if (count < most) points[count++] = p;
  }
};

/// For s = separation(a, b, aMb). No gap is less than s.distance, and one is that. Not of two half-spaces.
Manifold manifold(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s);

}  // namespace dyn
