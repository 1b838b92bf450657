// Depth of two convex cores that overlap: the expanding polytope (van den Bergen, "Proximity queries and penetration depth computation on 3D
// game objects", 2001).
#pragma once

#include "geometry/gjk.hpp"

namespace dyn {

struct Penetration {
  double depth = 0;  ///< of the cores: the least translation that parts them; tiny and negative where they do not quite touch
  Vec3<double> normal;
  Vec3<double> on_a, on_b;
};

/// From where gjk() found an overlap. Depth is that along the best direction met, so never too small; all faces of the polytope say that it
/// is not too large either, unless the solid is round all over (a ring of equally good directions), where the search goes down one of them.
Penetration epa(const Difference& difference, const GjkResult& start);

/// The same from a normal near the best one: for solids that hardly touch, where gjk() runs out of digits.
Penetration part(const Difference& difference, double size, const Vec3<double>& normal);

}  // namespace dyn
