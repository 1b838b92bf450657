// SPDX-License-Identifier: BSD-2-Clause
// Convex solids by their support function: a core grown by a margin. A sphere is a point with a margin, a capsule is a segment with a margin.
#pragma once

#include <dyn/spatial/se3.hpp>

#include <cmath>
#include <vector>

namespace dyn {

enum class Core { point, segment, box, cylinder, cone, hull, half_space };

/// A convex solid in its own frame.
struct Convex {
  Core core = Core::point;
  double margin = 0;
  /// Half the sides of a box; (radius, radius, half the length) of a cylinder or cone; (0, 0, half the length) of a segment; the unit normal of a
  /// half-space.
  Vec3<double> half;
  double offset = 0;                     ///< of a half-space, which is normal . x <= offset
  const Vec3<double>* points = nullptr;  ///< of a hull; not owned
  int count = 0;

  /// Returns a point of the core that is farthest along n. The length of n does not matter. Not for half-spaces.
  Vec3<double> support(const Vec3<double>& n) const {
    switch (core) {
      case Core::point:
      case Core::half_space:
        break;
      case Core::segment:
        return {0, 0, std::copysign(half.z, n.z)};
      case Core::box:
        return {std::copysign(half.x, n.x), std::copysign(half.y, n.y), std::copysign(half.z, n.z)};
      case Core::cylinder: {
        const Vec3<double> rim = onRim(n);
        return {rim.x, rim.y, std::copysign(half.z, n.z)};
      }
      case Core::cone: {
        const Vec3<double> rim = onRim(n);
        return dot(rim, n) > half.z * n.z ? rim : Vec3<double>{0, 0, half.z};
      }
      case Core::hull: {
        int best = 0;
        double farthest = dot(points[0], n);
        for (int i = 1; i < count; ++i) {
          const double x = dot(points[i], n);
          if (x > farthest) farthest = x, best = i;
        }
        return points[best];
      }
    }
    return {};
  }

 private:
  /// Returns the point farthest along n of the circle with radius half.x at z = -half.z.
  Vec3<double> onRim(const Vec3<double>& n) const {
    const double radial = std::sqrt(n.x * n.x + n.y * n.y);
    if (!(radial > 0)) return {half.x, 0, -half.z};
    const double s = half.x / radial;
    return {s * n.x, s * n.y, -half.z};
  }
};

/// Separation of two solids A and B, in the caller's axes: on_b - on_a = distance * normal.
struct Separation {
  double distance = 0;  ///< if negative, B must move by -distance along the normal until they only touch
  Vec3<double> normal;  ///< unit, from A towards B
  Vec3<double> on_a, on_b;
};

/// The Minkowski difference A - B of two cores, in the frame of A; aMb is the pose of B in A.
struct Difference {
  const Convex& a;
  const Convex& b;
  const SE3<double>& aMb;

  struct Point {
    Vec3<double> w, on_a, on_b;  ///< w = on_a - on_b
  };
  Point support(const Vec3<double>& n) const {
    Point p;
    p.on_a = a.support(n);
    p.on_b = aMb.act(b.support(-transposeTimes(aMb.R, n)));
    p.w = p.on_a - p.on_b;
    return p;
  }
};

inline double norm(const Vec3<double>& x) { return std::sqrt(dot(x, x)); }

/// Returns the signed distance of two solids. If it is larger than `beyond`, the returned distance may be any number larger than `beyond`. With
/// `touch_only` the returned distance of solids that touch may be any number that is not positive. The result is exact to a few units of roundoff of
/// the solids' sizes where the search ends at corners, edges and faces; to 1e-10 where cylinders or cones are apart, and to 2e-8 where they overlap.
/// No threshold is absolute.
Separation separation(const Convex& a, const Convex& b, const SE3<double>& aMb, double beyond, bool touch_only);

}  // namespace dyn
