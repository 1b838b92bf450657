// Distance of two convex cores that do not overlap: Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex
// objects in three-dimensional space", IEEE J. Robotics and Automation 4(2), 1988.
#pragma once

#include "geometry/convex.hpp"

#include <limits>

namespace dyn {

/// Twice what rounding changes a number by, at most, relative to it.
inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Up to four points of a Minkowski difference, and the convex combination of them that is nearest to the origin.
struct Simplex {
  Difference::Point points[4];
  double weight[4] = {};
  int count = 0;

  /// That combination, of the difference and of both solids.
  Difference::Point nearest() const;
  /// Finds the weights and forgets the points that have none. True if the origin is inside of four; `size` is that of the points' numbers.
  bool reduce(double size);
};

struct GjkResult {
  bool overlap = false;
  Vec3<double> v;                                                 ///< the difference's point nearest to the origin
  double lower_bound = -std::numeric_limits<double>::infinity();  ///< of the signed distance of the cores
  double size = 0;                                                ///< the largest |w| met
  Simplex simplex;
};

/// Stops early when the distance is sure to be larger than `beyond`.
GjkResult gjk(const Difference& difference, double beyond);

}  // namespace dyn
