// SPDX-License-Identifier: BSD-2-Clause
// Penetration depth of two convex cores by the expanding polytope algorithm (van den Bergen, "Proximity queries and penetration depth computation on
// 3D game objects", 2001).
#pragma once

#include "geometry/narrow/gjk.hpp"

namespace dyn {

struct Penetration {
  double depth = 0;  ///< of the cores: the shortest translation that separates them; slightly negative if they do not quite touch
  Vec3<double> normal;
  Vec3<double> on_a, on_b;
};

/// Starts from the simplex with which gjk() found an overlap. The depth is that along the best direction found, so it is never too small. The faces
/// of the polytope prove that it is not too large either, unless a round solid has a ring of equally good directions: the search then follows one.
Penetration epa(const Difference& difference, const GjkResult& start);

/// The same, from a normal near the best one. It serves for solids that barely touch, where rounding limits gjk().
Penetration part(const Difference& difference, double size, const Vec3<double>& normal);

}  // namespace dyn
