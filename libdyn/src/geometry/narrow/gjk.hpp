// SPDX-License-Identifier: BSD-2-Clause
// Distance of two convex cores that do not overlap: Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex
// objects in three-dimensional space", IEEE J. Robotics and Automation 4(2), 1988.
#pragma once

#include "geometry/narrow/convex.hpp"

#include <limits>

namespace dyn {

/// Twice the largest relative rounding error of a number.
inline constexpr double epsilon = std::numeric_limits<double>::epsilon();

/// Up to four points of a Minkowski difference, and the convex combination of them that is nearest to the origin.
struct Simplex {
  Difference::Point points[4];
  double weight[4] = {};
  int count = 0;

  /// Returns this combination as a point of the difference and as points of both solids.
  Difference::Point nearest() const;
  /// Finds the weights and drops points of weight zero. Returns true if the origin lies inside four points. `size` is the size of their numbers.
  bool reduce(double size);
};

struct GjkResult {
  bool overlap = false;
  Vec3<double> v;                                                 ///< the difference's point nearest to the origin
  double lower_bound = -std::numeric_limits<double>::infinity();  ///< lower bound of the signed distance of the cores
  double size = 0;                                                ///< largest |w| of the support points
  Simplex simplex;
};

/// Finds the distance of two cores. It stops early when the distance is proved to be larger than `beyond`.
GjkResult gjk(const Difference& difference, double beyond);

}  // namespace dyn
