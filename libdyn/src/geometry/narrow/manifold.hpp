// SPDX-License-Identifier: BSD-2-Clause
// Contact points of two convex solids: the face, edge or corner that each turns towards the other, clipped to the area that both share.
#pragma once

#include "geometry/narrow/convex.hpp"

#include <cstdint>

namespace dyn {

/// Returns the number of names for the corners that a solid can turn towards another.
int cornerIds(const Convex& c);

/// Ids of contact points of two solids with at most `corners` names for corners each. In this order they stand for: corners of A, corners of B, cuts
/// by edges of A, cuts by edges of B, the ends of a segment that two edges share, and nearest points by the foremost corner of either solid.
struct TouchingIds {
  int corners = 0;
  int cutting() const { return 2 * corners; }
  int shared() const { return 6 * corners; }
  std::int64_t nearest(int of_a, int of_b) const { return shared() + 2 + (corners + std::int64_t{1}) * of_a + of_b; }
  std::int64_t count() const { return nearest(corners, corners) + 1; }
};

/// A contact point in the axes of A; n is the normal of the separation.
struct TouchingPoint {
  Vec3<double> on_a;
  double gap = 0;       ///< [m] from on_a along n to B
  std::int64_t id = 0;  ///< the same as long as the same corners and edges meet
};

struct Manifold {
  static constexpr int most = 17;
  TouchingPoint points[most];
  int count = 0;

  void add(const TouchingPoint& p) {
    if (count < most) points[count++] = p;
  }
};

/// Returns the contact points for s = separation(a, b, aMb). `ids` must have enough names for either solid. No gap is less than s.distance, and one
/// gap equals it. Not for two half-spaces.
Manifold manifold(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s, const TouchingIds& ids);

}  // namespace dyn
