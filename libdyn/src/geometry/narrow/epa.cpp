// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/narrow/epa.hpp"

#include "at.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace dyn {

namespace {

constexpr int most_points = 160;
constexpr int most_faces = 2 * most_points;
constexpr int points_in_search = 96;  ///< with more points the search follows only the newest faces
constexpr double proof = 1e-8;        ///< the search ends if the depth found exceeds the true one by at most this fraction
constexpr int most_refinements = 8;

struct Face {
  int corner[3];
  int neighbour[3] = {-1, -1, -1};  ///< face across the edge from corner i to corner i + 1
  Vec3<double> normal;              ///< unit, outwards
  double distance = 0;              ///< signed distance of its plane from the origin
  bool alive = false, visible = false;
};

/// Returns a unit vector perpendicular to n.
Vec3<double> across(const Vec3<double>& n) {
  const double x = std::fabs(n.x), y = std::fabs(n.y), z = std::fabs(n.z);
  const Vec3<double> other = x <= y && x <= z ? Vec3<double>{1, 0, 0} : y <= z ? Vec3<double>{0, 1, 0} : Vec3<double>{0, 0, 1};
  const Vec3<double> c = cross(n, other);
  return (1 / norm(c)) * c;
}

/// A convex polytope inside the Minkowski difference, which grows by points of its surface.
class Polytope {
 public:
  Polytope(const Difference& difference, double size) : difference_(difference), size_(size) {}

  /// Starts with four points that span a volume. Returns false if the difference is flat; `normal` is then perpendicular to it.
  bool begin(const Simplex& simplex, Vec3<double>& normal) {
    points_ = 0;
    for (int i = 0; i < simplex.count; ++i) add(simplex.points[i]);
    const double flat = 100 * epsilon * size_;
    // Each further point is the one found farthest from the point, line or plane through the points before it.
    static const Vec3<double> directions[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    Vec3<double> along;
    const auto fromPoint = [&](const Vec3<double>& w) { return norm(w - point_[0].w); };
    const auto fromLine = [&](const Vec3<double>& w) { return norm(cross(along, w - point_[0].w)); };
    normal = {1, 0, 0};
    int second = farthest(1, fromPoint);
    if (second < 0 || fromPoint(point_[at(second)].w) <= flat) second = addFarthest(directions, 7, fromPoint);
    if (fromPoint(point_[at(second)].w) <= flat) return false;
    std::swap(point_[1], point_[at(second)]);
    along = (1 / fromPoint(point_[1].w)) * (point_[1].w - point_[0].w);
    normal = across(along);
    int third = farthest(2, fromLine);
    if (third < 0 || fromLine(point_[at(third)].w) <= flat) {
      const Vec3<double> other = cross(along, normal);
      const Vec3<double> around[] = {normal, other, normal + other, normal - other};
      third = addFarthest(around, 4, fromLine);
    }
    if (fromLine(point_[at(third)].w) <= flat) return false;
    std::swap(point_[2], point_[at(third)]);
    normal = cross(along, point_[2].w - point_[0].w);
    normal = (1 / norm(normal)) * normal;
    const auto fromPlane = [&](const Vec3<double>& w) { return std::fabs(dot(normal, w - point_[0].w)); };
    int fourth = farthest(3, fromPlane);
    if (fourth < 0 || fromPlane(point_[at(fourth)].w) <= flat) fourth = addFarthest(&normal, 1, fromPlane);
    if (fromPlane(point_[at(fourth)].w) <= flat) return false;
    std::swap(point_[3], point_[at(fourth)]);
    points_ = 4;
    const bool above = dot(normal, point_[3].w - point_[0].w) > 0;
    const int b = above ? 2 : 1, c = above ? 1 : 2;
    faces_ = 4;
    face_[0] = make(0, b, c);
    face_[1] = make(0, 3, b);
    face_[2] = make(b, 3, c);
    face_[3] = make(c, 3, 0);
    link(0, {1, 2, 3});
    link(1, {3, 2, 0});
    link(2, {1, 3, 0});
    link(3, {2, 1, 0});
    return true;
  }

  int points() const { return points_; }
  const Face& face(int i) const { return face_[at(i)]; }

  int nearestFace() const {
    int best = -1;
    for (int i = 0; i < faces_; ++i)
      if (face(i).alive && (best < 0 || face(i).distance < face(best).distance)) best = i;
    return best;
  }
  /// Returns the face nearest to the origin among those that the last grow() made.
  int nearestNewFace() const {
    int best = -1;
    for (int i = 0; i < made_; ++i)
      if (best < 0 || face(new_face_[i]).distance < face(best).distance) best = new_face_[i];
    return best;
  }

  /// Adds a point beyond face `from`. Returns false if rounding or lack of room prevents this; the polytope is then unusable.
  bool grow(int from, const Difference::Point& p) {
    if (points_ == most_points) return false;
    const int apex = points_;
    add(p);
    visible_ = 0;
    see(from);
    for (int k = 0; k < visible_; ++k)
      for (const int next : face(seen_[k]).neighbour)
        if (!face(next).visible && dot(face(next).normal, p.w) - face(next).distance > 4 * epsilon * size_) see(next);
    // Each edge on the rim of the visible faces becomes the base of a new face. The edges must form one closed line.
    made_ = 0;
    for (int k = 0; k < visible_; ++k) {
      for (int i = 0; i < 3; ++i) {
        const Face& f = face(seen_[k]);
        const int beyond = f.neighbour[i];
        if (face(beyond).visible) continue;
        const int index = freeFace();
        if (index < 0) return false;
        const int a = f.corner[i], b = f.corner[(i + 1) % 3];
        Face& made = face_[at(index)];
        made = make(a, b, apex);
        if (!made.alive) return false;
        made.neighbour[0] = beyond;
        starts_at_[at(a)] = index;
        new_face_[made_++] = index;
      }
    }
    for (int k = 0; k < made_; ++k) {
      Face& f = face_[at(new_face_[k])];
      const int next = starts_at_[at(f.corner[1])];
      if (next < 0) return false;
      f.neighbour[1] = next;
      face_[at(next)].neighbour[2] = new_face_[k];
      Face& outer = face_[at(f.neighbour[0])];
      for (int i = 0; i < 3; ++i)
        if (outer.corner[i] == f.corner[1] && outer.corner[(i + 1) % 3] == f.corner[0]) outer.neighbour[i] = new_face_[k];
    }
    // If the rim meets itself at a corner, some edges have no edge before them.
    for (int k = 0; k < made_; ++k)
      if (face(new_face_[k]).neighbour[2] < 0) return false;
    for (int k = 0; k < made_; ++k) starts_at_[at(face(new_face_[k]).corner[0])] = -1;
    for (int k = 0; k < visible_; ++k) {
      Face& f = face_[at(seen_[k])];
      f.alive = f.visible = false;
    }
    return true;
  }

 private:
  void add(const Difference::Point& p) {
    starts_at_[at(points_)] = -1;
    point_[at(points_++)] = p;
  }

  template <class Measure>
  int farthest(int from, const Measure& measure) const {
    int best = -1;
    for (int i = from; i < points_; ++i)
      if (best < 0 || measure(point_[at(i)].w) > measure(point_[at(best)].w)) best = i;
    return best;
  }
  template <class Measure>
  int addFarthest(const Vec3<double>* directions, int count, const Measure& measure) {
    const int index = points_;
    add(difference_.support(directions[0]));
    for (int k = 0; k < 2 * count; ++k) {
      const Difference::Point p = difference_.support(k < count ? directions[k] : -directions[k - count]);
      if (measure(p.w) > measure(point_[at(index)].w)) point_[at(index)] = p;
    }
    return index;
  }

  Face make(int a, int b, int c) const {
    Face f;
    f.corner[0] = a;
    f.corner[1] = b;
    f.corner[2] = c;
    const Vec3<double>&pa = corner(a), &pb = corner(b), &pc = corner(c);
    const Vec3<double> n = cross(pb - pa, pc - pa);
    const double area = norm(n);
    f.alive = area > 0;
    if (!f.alive) return f;
    f.normal = (1 / area) * n;
    f.distance = dot(f.normal, pa);
    return f;
  }
  const Vec3<double>& corner(int i) const { return point_[at(i)].w; }
  void link(int i, std::array<int, 3> neighbours) { std::copy(neighbours.begin(), neighbours.end(), face_[at(i)].neighbour); }
  void see(int i) {
    face_[at(i)].visible = true;
    seen_[visible_++] = i;
  }
  int freeFace() {
    if (faces_ < most_faces) return faces_++;
    for (int i = 0; i < most_faces; ++i)
      if (!face(i).alive) return i;
    return -1;
  }

  const Difference& difference_;
  double size_;
  int points_ = 0, faces_ = 0, visible_ = 0, made_ = 0;
  std::array<Difference::Point, most_points + 4> point_;
  std::array<int, most_points + 4> starts_at_;
  std::array<Face, most_faces> face_;
  int seen_[most_faces];
  int new_face_[most_faces];
};

/// Grows the polytope to find the normal along which the shortest translation separates the solids, and the length of that translation.
void search(const Difference& difference, Polytope& polytope, double size, Penetration& out) {
  out.depth = std::numeric_limits<double>::infinity();
  for (int f = polytope.nearestFace(); f >= 0;) {
    const Face face = polytope.face(f);
    const Difference::Point p = difference.support(face.normal);
    const double reach = dot(face.normal, p.w);
    if (reach < out.depth) {
      out.depth = reach;
      out.normal = face.normal;
    }
    if (reach - face.distance <= proof * std::fabs(reach) + 8 * epsilon * size || !polytope.grow(f, p)) break;
    f = polytope.points() < points_in_search ? polytope.nearestFace() : polytope.nearestNewFace();
  }
}

/// Separates the solids along the normal, by a little more than needed, and finds their nearest points: there the solids touch last. If the normal
/// is not quite the best, the direction between these points is better: no point of A - B reaches farther along it than along the old normal.
void refine(const Difference& difference, double size, Penetration& out) {
  const double gap = size / 64;
  for (int k = 0; k < most_refinements; ++k) {
    SE3<double> parted = difference.aMb;
    const Vec3<double> shift = (out.depth + gap) * out.normal;
    parted.p += shift;
    const GjkResult r = gjk({difference.a, difference.b, parted}, std::numeric_limits<double>::infinity());
    if (r.overlap) return;
    const Difference::Point nearest = r.simplex.nearest();
    out.on_a = nearest.on_a;
    out.on_b = nearest.on_b - shift;
    const Vec3<double> normal = (-1 / norm(r.v)) * r.v;
    const double reach = dot(normal, difference.support(normal).w);
    const bool settled = !(out.depth - reach > 4 * epsilon * size);
    if (!(reach <= out.depth + 4 * epsilon * size)) return;
    out.depth = std::min(reach, out.depth);
    out.normal = normal;
    if (settled) return;
  }
}

}  // namespace

Penetration epa(const Difference& difference, const GjkResult& start) {
  Penetration out;
  Polytope polytope(difference, start.size);
  if (polytope.begin(start.simplex, out.normal)) search(difference, polytope, start.size, out);
  refine(difference, start.size, out);
  return out;
}

Penetration part(const Difference& difference, double size, const Vec3<double>& normal) {
  Penetration out;
  out.normal = normal;
  out.depth = dot(normal, difference.support(normal).w);
  refine(difference, size, out);
  return out;
}

}  // namespace dyn
