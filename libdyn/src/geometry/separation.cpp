// The signed distance of two solids: of cores by gjk() and epa(), margins taken off.
#include "geometry/epa.hpp"

#include <limits>

namespace dyn {

namespace {

/// Half-spaces have no support function, but a distance from everything that does.
Separation fromHalfSpace(const Convex& a, const Convex& b, const SE3<double>& aMb) {
  Separation s;
  s.normal = a.half;
  if (b.core == Core::half_space) {
    const bool facing = norm(a.half + aMb.R * b.half) <= 4 * std::numeric_limits<double>::epsilon();
    s.on_a = a.offset * a.half;
    s.on_b = aMb.act(b.offset * b.half);
    s.distance = facing ? dot(a.half, s.on_b) - a.offset : -std::numeric_limits<double>::infinity();
    if (facing) s.on_a = s.on_b - s.distance * s.normal;
    return s;
  }
  const Vec3<double> inward = -transposeTimes(aMb.R, a.half);
  s.on_b = aMb.act(b.support(inward)) - b.margin * a.half;
  s.distance = dot(a.half, s.on_b) - a.offset;
  s.on_a = s.on_b - s.distance * s.normal;
  return s;
}

void take(const Penetration& p, Separation& s) {
  s.normal = p.normal;
  s.distance = -p.depth;
  // Where round solids are left as soon one way as another, the points found are those of a way nearby.
  const Vec3<double> middle = 0.5 * (p.on_a + p.on_b), half = 0.5 * p.depth * p.normal;
  s.on_a = middle + half;
  s.on_b = middle - half;
}

}  // namespace

Separation separation(const Convex& a, const Convex& b, const SE3<double>& aMb, double beyond, bool touch_only) {
  if (a.core == Core::half_space) return fromHalfSpace(a, b, aMb);
  if (b.core == Core::half_space) {
    const Separation other = fromHalfSpace(b, a, aMb.inverse());
    return {other.distance, -(aMb.R * other.normal), aMb.act(other.on_b), aMb.act(other.on_a)};
  }
  const double margin = a.margin + b.margin;
  const Difference difference{a, b, aMb};
  const GjkResult found = gjk(difference, beyond + margin);
  Separation s;
  const double distance = norm(found.v);
  if (found.overlap) {
    if (touch_only && (margin > 0 || found.simplex.count == 4)) {
      s.distance = -margin;
      return s;
    }
    take(epa(difference, found), s);
  } else if (distance < found.size / 64 && distance - found.lower_bound > 1e-10 * found.size && distance <= beyond + margin) {
    take(part(difference, found.size, (-1 / distance) * found.v), s);
  } else {
    s.normal = (-1 / distance) * found.v;
    s.distance = distance;
    const Difference::Point nearest = found.simplex.nearest();
    s.on_a = nearest.on_a;
    s.on_b = nearest.on_b;
  }
  s.distance -= margin;
  s.on_a += a.margin * s.normal;
  s.on_b -= b.margin * s.normal;
  return s;
}

}  // namespace dyn
