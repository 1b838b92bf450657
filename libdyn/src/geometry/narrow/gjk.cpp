// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/narrow/gjk.hpp"

#include <algorithm>
#include <limits>

namespace dyn {

namespace {

constexpr int most_iterations = 128;

/// Writes the weights of the point of a segment that is nearest to the origin.
void nearestOfTwo(const Vec3<double>& a, const Vec3<double>& b, double* weight) {
  const Vec3<double> d = b - a;
  const double length2 = dot(d, d);
  const double t = length2 > 0 ? std::clamp(-dot(a, d) / length2, 0.0, 1.0) : 0.0;
  weight[0] = 1 - t;
  weight[1] = t;
}

/// The same for a triangle: the projection along the normal if it lies inside the triangle, else the best point of the edges.
void nearestOfThree(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c, double* weight) {
  const Vec3<double> n = cross(b - a, c - a);
  const double area2 = dot(n, n);
  if (area2 > 0) {
    // Signed areas, seen along n, of the triangles that the origin forms with the edges.
    const double wa = dot(n, cross(b, c)), wb = dot(n, cross(c, a)), wc = dot(n, cross(a, b));
    const double sum = wa + wb + wc;
    if (wa >= 0 && wb >= 0 && wc >= 0 && sum > 0) {
      weight[0] = wa / sum;
      weight[1] = wb / sum;
      weight[2] = wc / sum;
      return;
    }
  }
  const Vec3<double>* p[3] = {&a, &b, &c};
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    double w[2];
    nearestOfTwo(*p[i], *p[j], w);
    const Vec3<double> x = w[0] * *p[i] + w[1] * *p[j];
    if (dot(x, x) >= best) continue;
    best = dot(x, x);
    weight[i] = w[0];
    weight[j] = w[1];
    weight[3 - i - j] = 0;
  }
}

/// The same for a tetrahedron. Returns true if the origin is inside and the volume exceeds the rounding errors of points of this size.
bool nearestOfFour(const Difference::Point* p, double size, double* weight) {
  static constexpr int faces[4][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 3, 2, 0}};  // three corners and the opposite one
  double best = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (const auto& f : faces) {
    const Vec3<double>&a = p[f[0]].w, &b = p[f[1]].w, &c = p[f[2]].w, &d = p[f[3]].w;
    const Vec3<double> ab = b - a, ac = c - a, ad = d - a, n = cross(ab, ac);
    const double of_corner = dot(n, ad), of_origin = -dot(n, a);
    const double rounding = 16 * epsilon * size * (norm(ab) * norm(ac) + (norm(ab) + norm(ac)) * norm(ad));
    if (std::fabs(of_corner) > rounding && of_corner * of_origin >= 0) continue;  // the origin is on the corner's side
    inside = false;
    double w[3];
    nearestOfThree(a, b, c, w);
    const Vec3<double> x = w[0] * a + w[1] * b + w[2] * c;
    if (dot(x, x) >= best) continue;
    best = dot(x, x);
    for (int i = 0; i < 3; ++i) weight[f[i]] = w[i];
    weight[f[3]] = 0;
  }
  return inside;
}

}  // namespace

Difference::Point Simplex::nearest() const {
  Difference::Point x;
  for (int i = 0; i < count; ++i) {
    x.w += weight[i] * points[i].w;
    x.on_a += weight[i] * points[i].on_a;
    x.on_b += weight[i] * points[i].on_b;
  }
  return x;
}

bool Simplex::reduce(double size) {
  switch (count) {
    case 1:
      weight[0] = 1;
      break;
    case 2:
      nearestOfTwo(points[0].w, points[1].w, weight);
      break;
    case 3:
      nearestOfThree(points[0].w, points[1].w, points[2].w, weight);
      break;
    default:
      if (nearestOfFour(points, size, weight)) return true;
  }
  int kept = 0;
  for (int i = 0; i < count; ++i) {
    if (!(weight[i] > 0)) continue;
    points[kept] = points[i];
    weight[kept++] = weight[i];
  }
  count = kept;
  return false;
}

GjkResult gjk(const Difference& difference, double beyond) {
  GjkResult r;
  // Any first direction works. The direction between the frames' origins is often near the final one.
  Vec3<double> v = -difference.aMb.p;
  if (!(dot(v, v) > 0)) v = {1, 0, 0};
  Simplex& s = r.simplex;
  s.points[0] = difference.support(-v);
  s.weight[0] = 1;
  s.count = 1;
  // The opposite support point counts as well, because the first point may be the origin itself.
  r.size = std::max(norm(s.points[0].w), norm(difference.support(v).w));
  v = s.points[0].w;
  for (int k = 0; k < most_iterations; ++k) {
    const double v2 = dot(v, v);
    // Rounding cannot tell v from the origin.
    if (v2 <= 100 * epsilon * epsilon * r.size * r.size) {
      r.overlap = true;
      break;
    }
    const Difference::Point p = difference.support(-v);
    r.size = std::max(r.size, norm(p.w));
    const double vw = dot(v, p.w);
    r.lower_bound = std::max(r.lower_bound, vw / std::sqrt(v2));
    if (r.lower_bound > beyond || v2 - vw <= 8 * epsilon * v2) break;
    Simplex next = s;
    next.points[next.count++] = p;
    if (next.reduce(r.size)) {
      s = next;
      r.overlap = true;
      break;
    }
    const Vec3<double> nearer = next.nearest().w;
    if (!(dot(nearer, nearer) < v2)) break;  // rounding prevents further progress
    s = next;
    v = nearer;
  }
  r.v = v;
  return r;
}

}  // namespace dyn
