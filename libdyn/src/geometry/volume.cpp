// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/volume.hpp"

#include "at.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace dyn {

namespace {

Bounds boundsOf(const Convex& c) {
  Bounds b;
  switch (c.core) {
    case Core::half_space: {
      const double inf = std::numeric_limits<double>::infinity();
      return {{-inf, -inf, -inf}, {inf, inf, inf}};
    }
    case Core::hull:
      for (int i = 0; i < c.count; ++i) b.add(c.points[i]);
      return b;
    default:
      b.add(-c.half);
      b.add(c.half);
  }
  const Vec3<double> margin{c.margin, c.margin, c.margin};
  return {b.lower - margin, b.upper + margin};
}

/// Returns the radius of a sphere around `center` that contains the solid; infinity for a half-space.
double radiusOf(const Convex& c, const Vec3<double>& center) {
  switch (c.core) {
    case Core::half_space:
      return std::numeric_limits<double>::infinity();
    case Core::hull: {
      double r = 0;
      for (int i = 0; i < c.count; ++i) r = std::max(r, norm(c.points[i] - center));
      return r;
    }
    case Core::cylinder:
    case Core::cone:
      return std::hypot(c.half.x, c.half.z);
    default:
      return norm(c.half) + c.margin;
  }
}

}  // namespace

Bounds moved(const Bounds& b, const SE3<double>& X) {
  const Vec3<double> c = X.act(b.center()), h = b.half();
  Vec3<double> r;
  for (int i = 0; i < 3; ++i) r[i] = std::fabs(X.R(i, 0)) * h.x + std::fabs(X.R(i, 1)) * h.y + std::fabs(X.R(i, 2)) * h.z;
  return {c - r, c + r};
}

void BoxArray::add(int number, const Bounds& b) {
  for (int i = 0; i < 3; ++i) {
    lower_[i].push_back(b.lower[i]);
    upper_[i].push_back(b.upper[i]);
  }
  numbers_.push_back(number);
}

void BoxArray::gaps(const Bounds& b, std::size_t first, std::size_t count, double* __restrict gap) const {
  const auto larger = [](double x, double y) { return x > y ? x : y; };
  const double *const lx = lower_[0].data() + first, *const ly = lower_[1].data() + first, *const lz = lower_[2].data() + first;
  const double *const ux = upper_[0].data() + first, *const uy = upper_[1].data() + first, *const uz = upper_[2].data() + first;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = larger(lx[i] - b.upper.x, b.lower.x - ux[i]), y = larger(ly[i] - b.upper.y, b.lower.y - uy[i]);
    gap[i] = larger(larger(x, y), larger(lz[i] - b.upper.z, b.lower.z - uz[i]));
  }
}

void Volume::addPiece(const Convex& piece, const Vec3<double>& center, const Bounds& bounds) {
  pieces_.push_back(piece);
  centers_.push_back(center);
  bounds_.add(bounds);
}

Volume Volume::solid(const Convex& convex) {
  Volume v;
  v.addPiece(convex, {}, boundsOf(convex));
  v.radius_ = radiusOf(convex, {});
  return v;
}

Volume Volume::hull(std::vector<Vec3<double>> points) {
  Volume v;
  v.points_ = std::move(points);
  Convex c;
  c.core = Core::hull;
  c.points = v.points_.data();
  c.count = static_cast<int>(v.points_.size());
  v.addPiece(c, {}, boundsOf(c));
  v.radius_ = radiusOf(c, v.bounds_.center());
  return v;
}

Volume Volume::triangles(const std::vector<Vec3<double>>& vertices, const std::vector<std::array<int, 3>>& triangles) {
  Volume v;
  for (const auto& t : triangles)
    for (const int corner : t) v.points_.push_back(vertices[at(corner)]);
  std::vector<Bounds> bounds;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    Convex c;
    c.core = Core::hull;
    c.points = v.points_.data() + 3 * i;
    c.count = 3;
    bounds.push_back(boundsOf(c));
    v.addPiece(c, {}, bounds.back());
  }
  for (const Vec3<double>& x : v.points_) v.radius_ = std::max(v.radius_, norm(x - v.bounds_.center()));
  v.buildTree(bounds);
  return v;
}

Volume Volume::cubes(const std::vector<geometry::Voxels::Cube>& cubes) {
  Volume v;
  std::vector<Bounds> bounds;
  for (const auto& cube : cubes) {
    Convex c;
    c.core = Core::box;
    c.half = {0.5 * cube.size, 0.5 * cube.size, 0.5 * cube.size};
    bounds.push_back({cube.center - c.half, cube.center + c.half});
    v.addPiece(c, cube.center, bounds.back());
  }
  for (const auto& cube : cubes) v.radius_ = std::max(v.radius_, norm(cube.center - v.bounds_.center()) + std::sqrt(0.75) * cube.size);
  v.buildTree(bounds);
  return v;
}

/// Splits at the median along the longest side, so the depth of the tree is the logarithm of its size.
void Volume::buildTree(const std::vector<Bounds>& bounds) {
  if (bounds.empty()) return;
  std::vector<int> order(bounds.size());
  std::iota(order.begin(), order.end(), 0);
  struct Task {
    int first, last, node;
  };
  nodes_.reserve(2 * bounds.size());
  nodes_.push_back({});
  std::vector<Task> tasks{{0, static_cast<int>(bounds.size()), 0}};
  while (!tasks.empty()) {
    const Task t = tasks.back();
    tasks.pop_back();
    Bounds around, centers;
    for (int i = t.first; i < t.last; ++i) {
      around.add(bounds[at(order[at(i)])]);
      centers.add(bounds[at(order[at(i)])].center());
    }
    nodes_[at(t.node)].bounds = around;
    if (t.last - t.first == 1) {
      nodes_[at(t.node)].piece = order[at(t.first)];
      continue;
    }
    const Vec3<double> side = centers.half();
    const int axis = side.x >= side.y && side.x >= side.z ? 0 : side.y >= side.z ? 1 : 2;
    const int middle = (t.first + t.last) / 2;
    std::nth_element(order.begin() + t.first, order.begin() + middle, order.begin() + t.last, [&](int a, int b) {
      const double x = bounds[at(a)].center()[axis], y = bounds[at(b)].center()[axis];
      return x != y ? x < y : a < b;
    });
    const int left = static_cast<int>(nodes_.size());
    nodes_[at(t.node)].left = left;
    nodes_[at(t.node)].right = left + 1;
    nodes_.resize(nodes_.size() + 2);
    tasks.push_back({t.first, middle, left});
    tasks.push_back({middle, t.last, left + 1});
  }
}

}  // namespace dyn
