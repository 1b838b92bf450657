// SPDX-License-Identifier: BSD-2-Clause
// Distances of placed solids in long double, by definitions and closed forms. This code shares only the description of shapes with the library.
#pragma once

#include <dyn/model/geometry_description.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace dyn::test {

using Wide = long double;
using V3 = Vec3<Wide>;

inline V3 wide(const Vec3<double>& x) { return {x.x, x.y, x.z}; }
inline Wide length(const V3& x) { return std::sqrt(dot(x, x)); }
inline V3 unit(const V3& x) { return (1 / length(x)) * x; }

struct Placed {
  GeometryShape shape;
  SE3<Wide> pose;
};

inline V3 support(const geometry::Sphere& s, const V3& n) { return s.radius * unit(n); }
inline V3 support(const geometry::Box& b, const V3& n) {
  return {std::copysign(Wide(b.size.x) / 2, n.x), std::copysign(Wide(b.size.y) / 2, n.y), std::copysign(Wide(b.size.z) / 2, n.z)};
}
inline V3 support(const geometry::Capsule& c, const V3& n) { return V3{0, 0, std::copysign(Wide(c.length) / 2, n.z)} + c.radius * unit(n); }
inline V3 rim(Wide radius, const V3& n) {
  const Wide r = std::hypot(n.x, n.y);
  return r > 0 ? V3{radius * n.x / r, radius * n.y / r, 0} : V3{radius, 0, 0};
}
inline V3 support(const geometry::Cylinder& c, const V3& n) { return rim(c.radius, n) + V3{0, 0, std::copysign(Wide(c.length) / 2, n.z)}; }
inline V3 support(const geometry::Cone& c, const V3& n) {
  const V3 base = rim(c.radius, n) - V3{0, 0, Wide(c.length) / 2}, tip{0, 0, Wide(c.length) / 2};
  return dot(base, n) > dot(tip, n) ? base : tip;
}
inline V3 support(const geometry::ConvexHull& h, const V3& n) {
  V3 best = wide(h.points.front());
  for (const auto& x : h.points)
    if (dot(wide(x), n) > dot(best, n)) best = wide(x);
  return best;
}
template <class Other>
V3 support(const Other&, const V3&) {
  return {};
}

/// The point of a placed solid that is farthest along n, in the world.
inline V3 support(const Placed& x, const V3& n) {
  const V3 local = transposeTimes(x.pose.R, n);
  return x.pose.act(std::visit([&](const auto& s) { return support(s, local); }, x.shape));
}

/// The width of the gap between a and b along n, negative if they overlap. The signed distance is the largest such gap over all n.
inline Wide parted(const Placed& a, const Placed& b, const V3& n) { return dot(n, support(b, -n)) - dot(n, support(a, n)); }

/// A lower bound of the signed distance max over n of parted(n), by random uphill search from many starts with shrinking steps.
inline Wide mostParted(const Placed& a, const Placed& b, unsigned seed = 1) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  const auto random = [&] { return V3{normal(generator), normal(generator), normal(generator)}; };
  std::vector<V3> starts;
  for (const Placed* x : {&a, &b})
    for (int i = 0; i < 3; ++i)
      for (const Wide sign : {1, -1}) starts.push_back(sign * x->pose.R.col(i));
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const V3 c = cross(a.pose.R.col(i), b.pose.R.col(j));
      if (length(c) > 1e-9L) starts.insert(starts.end(), {unit(c), -unit(c)});
    }
  if (length(b.pose.p - a.pose.p) > 0) starts.push_back(unit(b.pose.p - a.pose.p));
  for (int k = 0; k < 1000; ++k) starts.push_back(unit(random()));
  std::sort(starts.begin(), starts.end(), [&](const V3& x, const V3& y) { return parted(a, b, x) > parted(a, b, y); });
  Wide best = -std::numeric_limits<Wide>::infinity();
  for (std::size_t k = 0; k < 8; ++k) {
    V3 n = starts[k];
    Wide value = parted(a, b, n);
    for (Wide step = 0.1L; step > 1e-12L;) {
      const V3 next = unit(n + step * random());
      const Wide there = parted(a, b, next);
      if (there > value) {
        value = there;
        n = next;
        step *= 1.5L;
      } else {
        step *= 0.94L;
      }
    }
    best = std::max(best, value);
  }
  return best;
}

// The functions ofPoint give the signed distance of a point from a solid in closed form, in the solid's frame.

inline Wide ofRectangle(Wide x, Wide y, Wide half_x, Wide half_y) {
  const Wide dx = std::fabs(x) - half_x, dy = std::fabs(y) - half_y;
  return dx > 0 || dy > 0 ? std::hypot(std::max(dx, Wide(0)), std::max(dy, Wide(0))) : std::max(dx, dy);
}
inline Wide ofPoint(const V3& p, const geometry::Sphere& s) { return length(p) - s.radius; }
inline Wide ofPoint(const V3& p, const geometry::Box& b) {
  const Wide d[] = {std::fabs(p.x) - b.size.x / 2, std::fabs(p.y) - b.size.y / 2, std::fabs(p.z) - b.size.z / 2};
  const Wide inside = std::max({d[0], d[1], d[2]});
  if (inside <= 0) return inside;
  Wide sum = 0;
  for (const Wide x : d) sum += x > 0 ? x * x : 0;
  return std::sqrt(sum);
}
inline Wide ofPoint(const V3& p, const geometry::Capsule& c) {
  const Wide half = Wide(c.length) / 2, z = p.z - std::clamp(p.z, -half, half);
  return length(V3{p.x, p.y, z}) - c.radius;
}
inline Wide ofPoint(const V3& p, const geometry::Cylinder& c) { return ofRectangle(std::hypot(p.x, p.y), p.z, c.radius, Wide(c.length) / 2); }
/// Works in the half-plane of the axis and the point, with base, side and the corners between them.
inline Wide ofPoint(const V3& p, const geometry::Cone& c) {
  const Wide r = std::hypot(p.x, p.y), h = c.length, R = c.radius, z = p.z + h / 2;  // the base is at z = 0, the tip at (0, h)
  const Wide slant = std::hypot(R, h);
  const Wide side = (h * (r - R) + R * z) / slant;    // signed distance from the side's line
  const Wide along = (-R * (r - R) + h * z) / slant;  // position along this line, from the base's rim up
  if (z <= 0 && r <= R) return -z;
  if (side <= 0 && z >= 0) return std::max(side, -z);
  if (along >= slant) return std::hypot(r, z - h);
  if (along <= 0) return std::hypot(r - R, z);
  return side;
}

/// For an octahedron on the axes this is only the distance from the nearest face's plane, which tells whether the point is inside.
inline Wide ofPoint(const V3& p, const geometry::ConvexHull& h) {
  const Wide a = h.points[0].x, b = h.points[2].y, c = h.points[4].z;
  return (std::fabs(p.x) / a + std::fabs(p.y) / b + std::fabs(p.z) / c - 1) / length({1 / a, 1 / b, 1 / c});
}

/// Signed distance of a point of the world from a placed solid, negative inside.
inline Wide outside(const Placed& x, const V3& point) {
  const V3 local = x.pose.actInv(point);
  return std::visit(
      [&](const auto& solid) -> Wide {
        if constexpr (requires { ofPoint(local, solid); }) return ofPoint(local, solid);
        return std::numeric_limits<Wide>::infinity();
      },
      x.shape);
}

/// Corners, sides and faces of a polytope in the world: a box, a hull, a capsule's segment or a sphere's centre.
struct Polytope {
  std::vector<V3> corners;
  std::vector<std::array<int, 2>> sides;
  std::vector<std::array<int, 3>> faces;
};

inline Polytope polytopeOf(const Placed& x) {
  Polytope p;
  if (const auto* box = std::get_if<geometry::Box>(&x.shape)) {
    const V3 h = Wide(0.5) * wide(box->size);
    for (int i = 0; i < 8; ++i) p.corners.push_back(x.pose.act(V3{i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z}));
    for (int i = 0; i < 8; ++i)
      for (int bit = 1; bit < 8; bit *= 2)
        if (!(i & bit)) p.sides.push_back({i, i | bit});
    for (const auto& q : {std::array{0, 1, 3, 2}, std::array{4, 6, 7, 5}, std::array{0, 4, 5, 1}, std::array{2, 3, 7, 6}, std::array{0, 2, 6, 4},
                          std::array{1, 5, 7, 3}}) {
      p.faces.push_back({q[0], q[1], q[2]});
      p.faces.push_back({q[0], q[2], q[3]});
    }
  } else if (const auto* capsule = std::get_if<geometry::Capsule>(&x.shape)) {
    for (const Wide s : {-0.5L, 0.5L}) p.corners.push_back(x.pose.act(V3{0, 0, s * capsule->length}));
    p.sides.push_back({0, 1});
  } else if (std::holds_alternative<geometry::Sphere>(x.shape)) {
    p.corners.push_back(x.pose.p);
  } else {
    // The tests' hulls have six points, two on each axis.
    for (const auto& c : std::get<geometry::ConvexHull>(x.shape).points) p.corners.push_back(x.pose.act(wide(c)));
    for (int i = 0; i < 6; ++i)
      for (int j = i + 1; j < 6; ++j)
        if (i / 2 != j / 2) p.sides.push_back({i, j});
    for (const int i : {0, 1})
      for (const int j : {2, 3})
        for (const int k : {4, 5}) p.faces.push_back({i, j, k});
  }
  return p;
}

inline Wide pointSegment(const V3& p, const V3& x, const V3& y) {
  const V3 e = y - x;
  const Wide t = std::clamp(dot(p - x, e) / dot(e, e), Wide(0), Wide(1));
  return length(p - (x + t * e));
}

inline Wide segments(const V3& a, const V3& b, const V3& c, const V3& d) {
  // The nearest points are ends, or, if they lie within both segments, the feet of the common perpendicular.
  Wide best = std::min({pointSegment(a, c, d), pointSegment(b, c, d), pointSegment(c, a, b), pointSegment(d, a, b)});
  const V3 u = b - a, v = d - c, w = a - c;
  const Wide uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w), D = uu * vv - uv * uv;
  if (D > 0) {
    const Wide s = (uv * vw - vv * uw) / D, t = (uu * vw - uv * uw) / D;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) best = std::min(best, length(w + s * u - t * v));
  }
  return best;
}

/// Signed distance of two polytopes without margins: by separating axes if they overlap, else by nearest features.
inline Wide ofPolytopes(const Polytope& a, const Polytope& b) {
  const auto apart = [&](const V3& n) {
    Wide top = -std::numeric_limits<Wide>::infinity(), bottom = -top;
    for (const V3& x : a.corners) top = std::max(top, dot(n, x));
    for (const V3& x : b.corners) bottom = std::min(bottom, dot(n, x));
    return bottom - top;
  };
  Wide depth = -std::numeric_limits<Wide>::infinity();
  const auto axis = [&](const V3& n) {
    if (length(n) > 0) depth = std::max({depth, apart(unit(n)), apart(-unit(n))});
  };
  for (const Polytope* p : {&a, &b})
    for (const auto& f : p->faces)
      axis(cross(p->corners[static_cast<std::size_t>(f[1])] - p->corners[static_cast<std::size_t>(f[0])],
                 p->corners[static_cast<std::size_t>(f[2])] - p->corners[static_cast<std::size_t>(f[0])]));
  const auto side = [](const Polytope& p, const std::array<int, 2>& s) {
    return std::pair(p.corners[static_cast<std::size_t>(s[0])], p.corners[static_cast<std::size_t>(s[1])]);
  };
  for (const auto& s : a.sides)
    for (const auto& t : b.sides) {
      const auto [p, q] = side(a, s);
      const auto [r, u] = side(b, t);
      const V3 n = cross(q - p, u - r);
      if (length(n) > 1e-12L * length(q - p) * length(u - r)) axis(n);
    }
  if (depth <= 0 && std::isfinite(depth)) return depth;
  Wide best = std::numeric_limits<Wide>::infinity();
  for (const auto& s : a.sides)
    for (const auto& t : b.sides) {
      const auto [p, q] = side(a, s);
      const auto [r, u] = side(b, t);
      best = std::min(best, segments(p, q, r, u));
    }
  for (const V3& p : a.corners)
    for (const V3& q : b.corners) best = std::min(best, length(p - q));
  const auto cornersToRest = [&](const Polytope& points, const Polytope& solid) {
    for (const auto& s : solid.sides)
      for (const V3& p : points.corners) best = std::min(best, pointSegment(p, side(solid, s).first, side(solid, s).second));
    for (const auto& f : solid.faces) {
      const V3 &x = solid.corners[static_cast<std::size_t>(f[0])], &y = solid.corners[static_cast<std::size_t>(f[1])],
               &z = solid.corners[static_cast<std::size_t>(f[2])];
      const V3 n = unit(cross(y - x, z - x));
      for (const V3& p : points.corners) {
        const V3 foot = p - dot(n, p - x) * n;
        const bool within = dot(n, cross(y - x, foot - x)) >= 0 && dot(n, cross(z - y, foot - y)) >= 0 && dot(n, cross(x - z, foot - z)) >= 0;
        if (within) best = std::min(best, std::fabs(dot(n, p - x)));
      }
    }
  };
  cornersToRest(a, b);
  cornersToRest(b, a);
  return best;
}

}  // namespace dyn::test
