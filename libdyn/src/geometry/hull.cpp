// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/files.hpp"
#include "geometry/volume.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

namespace dyn {

std::vector<Vec3<double>> hullCorners(const std::vector<Vec3<double>>& points) {
  if (points.size() <= 4) return points;
  std::vector<double> numbers;
  numbers.reserve(3 * points.size());
  for (const Vec3<double>& x : points) numbers.insert(numbers.end(), {x.x, x.y, x.z});

  // qhull prints a message if the points lie in a plane. Here that is no error.
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> nowhere(std::fopen("/dev/null", "w"), &std::fclose);
  qhT memory{};
  qhT* qh = &memory;
  qh_zero(qh, nowhere.get());
  char options[] = "qhull Qt";
  const int failed = qh_new_qhull(qh, 3, static_cast<int>(points.size()), numbers.data(), False, options, nowhere.get(), nowhere.get());
  std::vector<int> corners;
  if (!failed) {
    const vertexT* vertex = qh->vertex_list;
    for (; vertex != nullptr && vertex->next != nullptr; vertex = vertex->next)
      corners.push_back(static_cast<int>((vertex->point - numbers.data()) / 3));
  }
  qh_freeqhull(qh, qh_ALL);
  int still_long = 0, still_short = 0;
  qh_memfreeshort(qh, &still_long, &still_short);
  if (failed) return points;

  std::sort(corners.begin(), corners.end());  // order of the input, since qhull's order depends on its memory
  std::vector<Vec3<double>> hull;
  hull.reserve(corners.size());
  for (const int i : corners) hull.push_back(points[static_cast<std::size_t>(i)]);
  return hull;
}

bool boundsConvexSolid(const geometry::TriangleMesh& mesh) {
  // Each edge of a triangle must be an edge of one other triangle, in the opposite direction.
  std::map<std::pair<int, int>, int> sides;
  for (const auto& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (++sides[{t[k], t[(k + 1) % 3]}] > 1) return false;
  for (const auto& [side, count] : sides)
    if (!sides.count({side.second, side.first})) return false;
  Bounds bounds;
  for (const Vec3<double>& x : mesh.vertices) bounds.add(x);
  const Vec3<double> sides_of_box = bounds.upper - bounds.lower;
  const double slack = 1e-6 * norm(sides_of_box);
  double volume = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3<double>&a = mesh.vertices[static_cast<std::size_t>(t[0])], &b = mesh.vertices[static_cast<std::size_t>(t[1])],
          &c = mesh.vertices[static_cast<std::size_t>(t[2])];
    const Vec3<double> n = cross(b - a, c - a);
    const double area = norm(n);
    volume += dot(n, a - bounds.lower);
    // The plane of a sliver is undefined; the planes of its neighbours suffice.
    if (area <= 1e-12 * dot(sides_of_box, sides_of_box)) continue;
    for (const Vec3<double>& x : mesh.vertices)
      if (dot(n, x - a) > slack * area) return false;
  }
  return volume > 0;
}

}  // namespace dyn
