// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/narrow/manifold.hpp"

#include <algorithm>

namespace dyn {

namespace {

constexpr int round_corners = 8;                             ///< corners of the polygon that replaces a round face
constexpr int upper = 2 * round_corners, lower = upper + 1;  ///< names of a solid's two ends, after the names of rim corners

/// Two axes perpendicular to a unit vector and to each other. Equal vectors give equal axes.
struct Across {
  Vec3<double> u, v;
  explicit Across(const Vec3<double>& n) {
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3<double> least = x <= y && x <= z ? Vec3<double>{1, 0, 0} : y <= z ? Vec3<double>{0, 1, 0} : Vec3<double>{0, 0, 1};
    u = cross(n, least);
    u = (1 / norm(u)) * u;
    v = cross(n, u);
  }
};

/// A corner: coordinates (u, v) in a plane perpendicular to the normal, and height h along the normal.
struct Corner {
  double u = 0, v = 0, h = 0;
  int id = 0;
};

struct Polygon {
  Corner corners[2 * round_corners];
  int count = 0;
  void add(const Corner& c) {
    if (count < 2 * round_corners) corners[count++] = c;
  }
};

/// Calls add(point, name) for the corners of the feature (face, edge or corner) of a solid that is foremost along the unit vector n: at most eight,
/// in order around it. Only points and segments have margins. A name belongs to a place on the solid; on a tilted rim it is relative to the lowest
/// point, which is the farthest one along n.
template <class Add>
void face(const Convex& c, const Vec3<double>& n, const Add& add) {
  const auto rim = [&](double z) {
    const double radial = std::hypot(n.x, n.y);
    // A tilted disc rests on its lowest point, so the corners start there. The lowest point of a flat disc jumps, so its corners are fixed.
    const bool tilted = radial > 0.01;
    const double first = tilted ? std::atan2(n.y, n.x) : 0;
    for (int k = 0; k < round_corners; ++k) {
      const double angle = first + k * (2 * M_PI / round_corners);
      add(Vec3<double>{c.half.x * std::cos(angle), c.half.x * std::sin(angle), z}, tilted ? round_corners + k : k);
    }
  };
  constexpr double flat = 1e-3;  ///< slope up to which corners of a hull belong to one face
  switch (c.core) {
    case Core::point:
    case Core::half_space:
      add(c.margin * n, 0);
      return;
    case Core::segment: {
      // The end that is foremost along n touches with its cap. The other end touches with the line along the side, if n is more than 45 degrees
      // from the axis.
      const double radial = std::hypot(n.x, n.y), out = radial > 0 ? c.margin / radial : 0;
      for (const int end : {upper, lower}) {
        const Vec3<double> at{0, 0, end == upper ? c.half.z : -c.half.z};
        if ((end == lower) == std::signbit(n.z)) {
          add(at + c.margin * n, end);
        } else if (radial > M_SQRT1_2) {
          add(Vec3<double>{out * n.x, out * n.y, at.z}, end);
        }
      }
      return;
    }
    case Core::box: {
      const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
      const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2, p = (axis + 1) % 3, q = (axis + 2) % 3;
      constexpr int around[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
      for (const auto& sign : around) {
        Vec3<double> corner;
        corner[axis] = std::copysign(c.half[axis], n[axis]);
        corner[p] = sign[0] * c.half[p];
        corner[q] = sign[1] * c.half[q];
        add(corner, (corner.x > 0 ? 1 : 0) + (corner.y > 0 ? 2 : 0) + (corner.z > 0 ? 4 : 0));
      }
      return;
    }
    case Core::cylinder: {
      if (std::abs(n.z) > M_SQRT1_2) return rim(std::copysign(c.half.z, n.z));
      Vec3<double> side = c.support(n);
      side.z = c.half.z;
      add(side, upper);
      side.z = -c.half.z;
      add(side, lower);
      return;
    }
    case Core::cone: {
      if (n.z < -M_SQRT1_2) return rim(-c.half.z);
      add(Vec3<double>{0, 0, c.half.z}, upper);
      const double radial = std::hypot(n.x, n.y);
      if (radial > 0 && n.z < M_SQRT1_2) add(Vec3<double>{c.half.x * n.x / radial, c.half.x * n.y / radial, -c.half.z}, lower);
      return;
    }
    case Core::hull: {
      const Vec3<double> lowest = c.support(n);
      const Across axes(n);
      int before = -1, first = -1;
      for (int k = 0; k < round_corners; ++k) {
        const double angle = k * (2 * M_PI / round_corners);
        const Vec3<double> outward = std::cos(angle) * axes.u + std::sin(angle) * axes.v;
        int best = -1;
        double farthest = -HUGE_VAL;
        for (int i = 0; i < c.count; ++i) {
          const Vec3<double> from = c.points[i] - lowest;
          const double below = -dot(from, n), out = dot(from, outward);
          if (below <= flat * norm(from) && out > farthest) {
            best = i;
            farthest = out;
          }
        }
        if (best == before || best == first) continue;
        if (k == 0) first = best;
        before = best;
        add(c.points[best], best);
      }
      return;
    }
  }
}

class Facing {
 public:
  Facing(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s, const TouchingIds& ids)
      : a_(a), b_(b), aMb_(aMb), s_(s), n_(s.normal), ids_(ids), axes_(s.normal), origin_(s.on_a) {}

  Manifold run() {
    const Polygon a = towardsB(), b = towardsA();
    // A half-space covers the other solid's whole face. Its surface is at the height of on_a, which is 0, or of on_b.
    if (a_.core == Core::half_space) {
      for (int k = 0; k < b.count; ++k) out_.add({point(b.corners[k].u, b.corners[k].v, 0), b.corners[k].h, b.corners[k].id});
    } else if (b_.core == Core::half_space) {
      const double height = dot(s_.on_b - origin_, n_);
      for (int k = 0; k < a.count; ++k) {
        const Corner& c = a.corners[k];
        out_.add({point(c.u, c.v, c.h), height - c.h, c.id});
      }
    } else {
      share(a, b);
    }
    addNearest(a, b);
    return out_;
  }

 private:
  Corner flatten(const Vec3<double>& x, int id) const {
    const Vec3<double> d = x - origin_;
    return {dot(d, axes_.u), dot(d, axes_.v), dot(d, n_), id};
  }
  Vec3<double> point(double u, double v, double h) const { return origin_ + u * axes_.u + v * axes_.v + h * n_; }

  Polygon towardsB() const {
    Polygon p;
    face(a_, n_, [&](const Vec3<double>& x, int name) { p.add(flatten(x, name)); });
    return p;
  }
  Polygon towardsA() const {
    Polygon p;
    face(b_, -transposeTimes(aMb_.R, n_), [&](const Vec3<double>& x, int name) { p.add(flatten(aMb_.act(x), ids_.corners + name)); });
    return p;
  }

  void share(const Polygon& a, const Polygon& b) {
    if (a.count < 2 || b.count < 2) return;
    if (b.count == 2 && a.count == 2) return alongside(a, b);
    const bool cut_a = b.count > 2;
    Polygon cut = cut_a ? a : b;
    const Polygon& by = cut_a ? b : a;
    Slope slope;
    if (!slopeOf(by, slope)) return;
    clip(cut, by);
    for (int k = 0; k < cut.count; ++k) {
      const Corner& c = cut.corners[k];
      const double other = slope.at(c.u, c.v), on_a = cut_a ? c.h : other, on_b = cut_a ? other : c.h;
      out_.add({point(c.u, c.v, on_a), on_b - on_a, c.id});
    }
  }

  /// The plane of a polygon, h as a function of (u, v).
  struct Slope {
    double h = 0, by_u = 0, by_v = 0;
    double at(double u, double v) const { return h + by_u * u + by_v * v; }
  };
  /// Returns false for a polygon that is seen edge-on.
  static bool slopeOf(const Polygon& p, Slope& slope) {
    // The normal by Newell's method.
    Vec3<double> normal, middle;
    double size = 0;
    for (int k = 0; k < p.count; ++k) {
      const Corner &c = p.corners[k], &d = p.corners[(k + 1) % p.count];
      normal += Vec3<double>{(c.v - d.v) * (c.h + d.h), (c.h - d.h) * (c.u + d.u), (c.u - d.u) * (c.v + d.v)};
      middle += (1.0 / p.count) * Vec3<double>{c.u, c.v, c.h};
      size = std::max(size, std::hypot(c.u - d.u, c.v - d.v));
    }
    constexpr double thin = 1e-6;
    if (!(std::abs(normal.z) > thin * size * size)) return false;
    slope.by_u = -normal.x / normal.z;
    slope.by_v = -normal.y / normal.z;
    slope.h = middle.z - slope.by_u * middle.x - slope.by_v * middle.y;
    return true;
  }

  /// Clips `p` to the inside of the convex polygon `by` (Sutherland and Hodgman 1974). Where an edge of `by` cuts `p`, the id of the new corner comes
  /// from that edge's first corner and from whether the path around `p` enters or leaves there.
  void clip(Polygon& p, const Polygon& by) const {
    double area = 0;
    for (int k = 0; k < by.count; ++k) {
      const Corner &c = by.corners[k], &d = by.corners[(k + 1) % by.count];
      area += c.u * d.v - d.u * c.v;
    }
    for (int k = 0; k < by.count && p.count > 0; ++k) {
      const Corner &c = by.corners[k], &d = by.corners[(k + 1) % by.count];
      const auto inside = [&](const Corner& x) { return std::copysign(1.0, area) * ((d.u - c.u) * (x.v - c.v) - (d.v - c.v) * (x.u - c.u)); };
      Polygon kept;
      for (int i = 0; i < p.count; ++i) {
        const Corner &x = p.corners[i], &y = p.corners[(i + 1) % p.count];
        const double ix = inside(x), iy = inside(y);
        if (ix >= 0) kept.add(x);
        if ((ix < 0) == (iy < 0) || (p.count == 2 && i == 1)) continue;
        const double s = ix / (ix - iy);
        kept.add({x.u + s * (y.u - x.u), x.v + s * (y.v - x.v), x.h + s * (y.h - x.h), ids_.cutting() + 2 * c.id + (iy >= 0 ? 1 : 0)});
      }
      p = kept;
    }
  }

  /// Contact of two edges. Parallel edges share a segment, whose ends are added. Crossing edges share only the nearest points (see addNearest).
  void alongside(const Polygon& a, const Polygon& b) {
    const Corner &p = a.corners[0], &q = a.corners[1], &r = b.corners[0], &t = b.corners[1];
    const double along = std::hypot(q.u - p.u, q.v - p.v), other = std::hypot(t.u - r.u, t.v - r.v);
    constexpr double parallel = 0.02;
    if (!(along > 0) || !(other > 0)) return;
    const double du = (q.u - p.u) / along, dv = (q.v - p.v) / along;
    if (std::abs(du * (t.v - r.v) - dv * (t.u - r.u)) > parallel * other) return;
    const double first = (r.u - p.u) * du + (r.v - p.v) * dv, last = (t.u - p.u) * du + (t.v - p.v) * dv;
    const double low = std::max(0.0, std::min(first, last)), high = std::min(along, std::max(first, last));
    if (!(high > low) || first == last) return;
    int id = ids_.shared();
    for (const double s : {low, high}) {
      const double share = s / along, on_a = p.h + share * (q.h - p.h), on_b = r.h + (s - first) / (last - first) * (t.h - r.h);
      out_.add({point(p.u + share * (q.u - p.u), p.v + share * (q.v - p.v), on_a), on_b - on_a, id++});
    }
  }

  /// Adds the nearest points if no point has a gap as small as theirs. This happens where faces meet at a corner or along an edge.
  void addNearest(const Polygon& a, const Polygon& b) {
    double lowest = HUGE_VAL, size = norm(s_.on_a) + norm(aMb_.p);
    for (int k = 0; k < out_.count; ++k) lowest = std::min(lowest, out_.points[k].gap);
    if (!(lowest > s_.distance + 1e-12 * size)) return;
    out_.add({s_.on_a, s_.distance, ids_.nearest(foremost(a, b, s_.on_a, 0), foremost(b, a, s_.on_b, ids_.corners))});
  }
  /// Returns the name of the corner of p that is nearest to x. If p is a face and `other` is not, it returns the number of names, which stands for no
  /// corner: the point may be anywhere in the face.
  int foremost(const Polygon& p, const Polygon& other, const Vec3<double>& x, int first_id) const {
    if (p.count > 2 && other.count <= 2) return ids_.corners;
    const Corner at = flatten(x, 0);
    const auto away = [&](const Corner& c) { return std::hypot(c.u - at.u, c.v - at.v, c.h - at.h); };
    return std::min_element(p.corners, p.corners + p.count, [&](const Corner& c, const Corner& d) { return away(c) < away(d); })->id - first_id;
  }

  const Convex &a_, &b_;
  const SE3<double>& aMb_;
  const Separation& s_;
  const Vec3<double>& n_;
  const TouchingIds ids_;
  Across axes_;
  Vec3<double> origin_;
  Manifold out_;
};

}  // namespace

int cornerIds(const Convex& c) { return c.core == Core::hull ? c.count : lower + 1; }

Manifold manifold(const Convex& a, const Convex& b, const SE3<double>& aMb, const Separation& s, const TouchingIds& ids) {
  return Facing(a, b, aMb, s, ids).run();
}

}  // namespace dyn
