// SPDX-License-Identifier: BSD-2-Clause
// Signed distance of two solids: gjk() and epa() find that of the cores, from which the margins are subtracted.
#include "geometry/narrow/epa.hpp"

#include <limits>

namespace dyn {

namespace {

/// A half-space has no support function. Its distance follows from the other solid's support point along the inward normal.
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

/// Fraction of the solids' size. If the solids are nearer to each other than that, the difference of two points has too few digits for a direction.
constexpr double nearly = 0x1p-20;

/// True if the nearest point of the difference does not determine the normal: the point is mostly rounding error, or its distance is not proved. The
/// error of the normal is at most sqrt(2 (1 - lower bound / distance)).
bool isUnsure(const GjkResult& found, double distance) {
  return distance < nearly * found.size || (distance < found.size / 64 && distance - found.lower_bound > 1e-14 * distance);
}

/// Returns the best normal among those of the last simplex's triangle or edge and that of its point nearest to the origin.
Vec3<double> normalOfFeatures(const Difference& difference, const GjkResult& found) {
  Vec3<double> best = (-1 / norm(found.v)) * found.v;
  double least = dot(best, difference.support(best).w);
  const auto offer = [&](const Vec3<double>& n) {
    const double length = norm(n);
    if (!(length > 0)) return;
    for (const double way : {1 / length, -1 / length}) {
      const double reach = dot(way * n, difference.support(way * n).w);
      if (reach < least) least = reach, best = way * n;
    }
  };
  const Difference::Point* p = found.simplex.points;
  if (found.simplex.count == 3) offer(cross(p[1].w - p[0].w, p[2].w - p[0].w));
  if (found.simplex.count == 2) {
    const Vec3<double> side = p[1].w - p[0].w;
    offer(found.v - (dot(found.v, side) / dot(side, side)) * side);
  }
  return best;
}

void take(const Penetration& p, Separation& s) {
  s.normal = p.normal;
  s.distance = -p.depth;
  // Round solids may separate along many normals equally well. The points found may then belong to a normal nearby, so they are corrected.
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
  } else if (distance <= beyond + margin && isUnsure(found, distance)) {
    const Vec3<double> normal = normalOfFeatures(difference, found);
    const bool parts = dot(normal, difference.support(normal).w) <= nearly * found.size;
    take(parts ? part(difference, found.size, normal) : epa(difference, found), s);
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
