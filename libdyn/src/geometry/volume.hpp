// SPDX-License-Identifier: BSD-2-Clause
// A compiled volume: one convex solid, or many convex pieces (triangles, cubes) in a tree of boxes. All numbers are in the geometry's own frame.
#pragma once

#include "geometry/narrow/convex.hpp"

#include <dyn/model/geometry_description.hpp>

#include <array>
#include <limits>
#include <vector>

namespace dyn {

/// An axis-aligned box.
struct Bounds {
  Vec3<double> lower{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec3<double> upper{-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};

  void add(const Vec3<double>& x) {
    for (int i = 0; i < 3; ++i) {
      lower[i] = std::fmin(lower[i], x[i]);
      upper[i] = std::fmax(upper[i], x[i]);
    }
  }
  void add(const Bounds& b) {
    add(b.lower);
    add(b.upper);
  }
  void grow(double by) {
    lower -= Vec3<double>{by, by, by};
    upper += Vec3<double>{by, by, by};
  }
  Vec3<double> center() const { return 0.5 * (lower + upper); }
  Vec3<double> half() const { return 0.5 * (upper - lower); }
  bool meets(const Bounds& b) const {
    return lower.x <= b.upper.x && b.lower.x <= upper.x && lower.y <= b.upper.y && b.lower.y <= upper.y && lower.z <= b.upper.z &&
           b.lower.z <= upper.z;
  }
};

/// Returns the smallest axis-aligned box around the box b after X has moved it.
Bounds moved(const Bounds& b, const SE3<double>& X);

/// Boxes stored by coordinate, so that one instruction tests several of them.
class BoxArray {
 public:
  void add(int number, const Bounds& b);
  int size() const { return static_cast<int>(numbers_.size()); }
  /// Calls found(number) for each box that overlaps `b`.
  template <class Found>
  void meeting(const Bounds& b, const Found& found) const {
    constexpr std::size_t block = 64;
    double gap[block];
    const std::size_t n = numbers_.size();
    for (std::size_t first = 0; first < n; first += block) {
      const std::size_t count = n - first < block ? n - first : block;
      gaps(b, first, count, gap);
      for (std::size_t i = 0; i < count; ++i)
        if (gap[i] <= 0) found(numbers_[first + i]);
    }
  }

 private:
  /// Writes, for each of `count` boxes, the largest of its gaps to `b` along the three axes; negative if the boxes overlap.
  void gaps(const Bounds& b, std::size_t first, std::size_t count, double* gap) const;

  std::vector<double> lower_[3], upper_[3];
  std::vector<int> numbers_;
};

class Volume {
 public:
  struct Node {
    Bounds bounds;
    int left = -1, right = -1;  ///< -1 in a leaf, which holds the piece `piece`
    int piece = 0;
  };

  static Volume solid(const Convex& convex);
  static Volume hull(std::vector<Vec3<double>> points);
  static Volume triangles(const std::vector<Vec3<double>>& vertices, const std::vector<std::array<int, 3>>& triangles);
  static Volume cubes(const std::vector<geometry::Voxels::Cube>& cubes);

  Volume(const Volume&) = delete;  // pieces point into points_
  Volume& operator=(const Volume&) = delete;
  Volume(Volume&&) = default;
  Volume& operator=(Volume&&) = default;

  /// True if there are no pieces: nothing collides with the volume then.
  bool empty() const { return pieces_.empty(); }
  /// True for one solid, which has no tree.
  bool single() const { return nodes_.empty() && !pieces_.empty(); }
  /// False for a half-space, whose box is infinite.
  bool bounded() const { return pieces_.empty() || pieces_.front().core != Core::half_space; }
  int pieces() const { return static_cast<int>(pieces_.size()); }
  const Convex& piece(int i) const { return pieces_[static_cast<std::size_t>(i)]; }
  const Vec3<double>& center(int i) const { return centers_[static_cast<std::size_t>(i)]; }  ///< centre of a piece in the volume's frame
  const Node& node(int i) const { return nodes_[static_cast<std::size_t>(i)]; }              ///< node 0 is the root
  const Bounds& bounds() const { return bounds_; }
  /// Radius of a sphere around the centre of bounds() that contains the volume.
  double radius() const { return radius_; }

 private:
  Volume() = default;
  void addPiece(const Convex& piece, const Vec3<double>& center, const Bounds& bounds);
  void buildTree(const std::vector<Bounds>& bounds);

  std::vector<Vec3<double>> points_;
  std::vector<Convex> pieces_;
  std::vector<Vec3<double>> centers_;
  std::vector<Node> nodes_;
  Bounds bounds_;
  double radius_ = 0;
};

}  // namespace dyn
