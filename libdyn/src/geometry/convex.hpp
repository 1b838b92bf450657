// Convex solids by their support function: a core grown by a margin. Spheres are points with a margin, capsules segments.
#pragma once

#include <dyn/spatial/se3.hpp>

#include <cmath>
#include <vector>

namespace dyn {

enum class Core { point, segment, box, cylinder, cone, hull, half_space };

/// In its own frame.
struct Convex {
  Core core = Core::point;
  double margin = 0;
  /// Half the sides of a box; (radius, radius, half the length) of a cylinder, cone or segment; the unit normal of a half-space.
  Vec3<double> half;
  double offset = 0;                     ///< of a half-space
  const Vec3<double>* points = nullptr;  ///< of a hull, which someone else keeps
  int count = 0;

  /// A point of the core that is farthest along n, which need not be of unit length. Not for half-spaces.
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
  /// Of the circle at -half.z.
  Vec3<double> onRim(const Vec3<double>& n) const {
    const double radial = std::sqrt(n.x * n.x + n.y * n.y);
    if (!(radial > 0)) return {half.x, 0, -half.z};
    const double s = half.x / radial;
    return {s * n.x, s * n.y, -half.z};
  }
};

/// The answer for two solids A and B, in the axes of whoever asks: on_b - on_a = distance * normal.
struct Separation {
  double distance = 0;  ///< negative: how far B must be moved along the normal until they only touch
  Vec3<double> normal;  ///< unit, from A towards B
  Vec3<double> on_a, on_b;
};

/// Points of the cores' Minkowski difference A - B, seen from A; aMb is B's pose in A.
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

/// Signed distance of two solids. `beyond`: once it is sure to be larger than this, any distance that is may be returned.
/// `touch_only`: so may any negative distance once it is sure to be negative. Exact to a few units of roundoff of the solids' sizes where the
/// search ends at corners, sides and faces; to 1e-10 where cylinders or cones are apart, to 2e-8 where they overlap. No threshold is absolute.
Separation separation(const Convex& a, const Convex& b, const SE3<double>& aMb, double beyond, bool touch_only);

}  // namespace dyn
