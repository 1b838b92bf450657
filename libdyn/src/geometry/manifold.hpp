// Where two convex solids rest on each other: what each turns towards the other, face, side or corner, cut to where both are.
#pragma once

#include "geometry/convex.hpp"

#include <algorithm>
#include <cstdint>

namespace dyn {

/// Names of corners that a solid can turn towards another.
inline int cornerIds(const Convex& c) { return c.core == Core::hull ? std::max(c.count, 1) : 18; }
/// Ids of points where solids touch of which none has more names for corners.
constexpr std::int64_t touchingIds(std::int64_t corner_ids) { return 6 * corner_ids + 2 + (corner_ids + 1) * (corner_ids + 1); }

/// In the axes of A, of a separation's normal n.
struct TouchingPoint {
  Vec3<double> on_a;
  double gap = 0;       ///< from there along n to B
  std::int64_t id = 0;  ///< the same as long as the same corners and sides meet
};

struct Manifold {
  static constexpr int most = 17;
  TouchingPoint points[most];
  int count = 0;

  void add(const TouchingPoint& p) {
    if (count < most) points[count++] = p;
  }
};

/// For s = separation(a, b, aMb); ids are below touchingIds(corner_ids), which is no less than either solid's. No gap is less than s.distance, and
/// one is that. Not of two half-spaces.
Manifold manifold(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s, int corner_ids);

}  // namespace dyn
