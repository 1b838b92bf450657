// Where two convex solids rest on each other: what each turns towards the other, face, side or corner, cut to where both are.
#pragma once

#include "geometry/convex.hpp"

#include <cstdint>

namespace dyn {

/// Names of corners that a solid can turn towards another.
int cornerIds(const Convex& c);

/// Ids of points where solids touch of which none has more names for corners: corners of A, of B, where sides of B cut A, sides of A cut B, a shared
/// piece of two sides, the nearest points by what is foremost of either.
struct TouchingIds {
  int corners = 0;
  int cutting() const { return 2 * corners; }
  int shared() const { return 6 * corners; }
  std::int64_t nearest(int of_a, int of_b) const { return shared() + 2 + (corners + std::int64_t{1}) * of_a + of_b; }
  std::int64_t count() const { return nearest(corners, corners) + 1; }
};

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

/// For s = separation(a, b, aMb); `ids` has names enough for either solid. No gap is less than s.distance, and
/// one is that. Not of two half-spaces.
Manifold manifold(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s, const TouchingIds& ids);

}  // namespace dyn
