// SPDX-License-Identifier: BSD-2-Clause
#include "geometry/narrow/narrow.hpp"

#include "geometry/narrow/fcl.hpp"

#include <algorithm>

namespace dyn {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Separation compare(const Convex& a, const Convex& b, const SE3<double>& aMb, const NarrowPhase& phase, double beyond, bool touch_only) {
  return phase.functions == GeometryOptions::Narrow::own ? separation(a, b, aMb, beyond, touch_only)
                                                         : fclSeparation(a, b, aMb, touch_only, phase.fcl_tolerance);
}

Volume::Node rootOf(const Volume& v) {
  Volume::Node root;
  if (!v.single()) return v.node(0);
  root.bounds = v.bounds();
  return root;
}

/// One of the two volumes, seen as a tree. A single solid is a tree of one node.
class Side {
 public:
  explicit Side(const Volume& v) : volume_(v), root_(rootOf(v)) {}
  const Volume::Node& node(int i) const { return volume_.single() ? root_ : volume_.node(i); }
  bool leaf(int i) const { return node(i).left < 0; }
  double extent(int i) const {
    const Vec3<double> h = node(i).bounds.half();
    return std::max({h.x, h.y, h.z});
  }
  const Volume& volume() const { return volume_; }

 private:
  const Volume& volume_;
  Volume::Node root_;
};

/// Returns a lower bound of the signed distance of the contents of two boxes. Contents of overlapping boxes overlap no deeper than the boxes.
double lowerBound(const Bounds& a, const Bounds& b) {
  double apart2 = 0, overlap = infinity;
  for (int i = 0; i < 3; ++i) {
    const double gap = std::max(b.lower[i] - a.upper[i], a.lower[i] - b.upper[i]);
    if (gap > 0) apart2 += gap * gap;
    overlap = std::min(overlap, -gap);
  }
  return apart2 > 0 ? std::sqrt(apart2) : -overlap;
}

class Search {
 public:
  Search(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase) : a_(a), b_(b), aMb_(aMb), phase_(phase) {}

  /// Calls visit(i, j) for pairs of pieces that may be no farther apart than `limit`, near ones first. Each call returns the next limit; -infinity
  /// stops the search.
  template <class Visit>
  void run(double limit, const Visit& visit) const {
    // Each step takes one pair and pushes at most two, one level deeper. The stack holds at most as many pairs as both trees have levels.
    struct Pair {
      int a, b;
      double bound;
    };
    Pair stack[2 * 64];
    int size = 0;
    stack[size++] = {0, 0, bound(0, 0)};
    while (size > 0) {
      const Pair p = stack[--size];
      if (p.bound > limit) continue;
      const bool leaf_a = a_.leaf(p.a), leaf_b = b_.leaf(p.b);
      if (leaf_a && leaf_b) {
        limit = visit(a_.node(p.a).piece, b_.node(p.b).piece);
        if (limit == -infinity) return;
        continue;
      }
      const bool split_a = !leaf_a && (leaf_b || a_.extent(p.a) >= b_.extent(p.b));
      const Volume::Node& node = split_a ? a_.node(p.a) : b_.node(p.b);
      Pair left = split_a ? Pair{node.left, p.b, 0} : Pair{p.a, node.left, 0};
      Pair right = split_a ? Pair{node.right, p.b, 0} : Pair{p.a, node.right, 0};
      left.bound = bound(left.a, left.b);
      right.bound = bound(right.a, right.b);
      if (left.bound < right.bound) std::swap(left, right);
      stack[size++] = left;
      stack[size++] = right;
    }
  }

  /// Returns the pose of b's piece j in a's piece i.
  SE3<double> between(int i, int j) const { return {aMb_.R, aMb_.act(b_.volume().center(j)) - a_.volume().center(i)}; }

  Separation pieces(int i, int j, double beyond, bool touch_only) const {
    const Volume &a = a_.volume(), &b = b_.volume();
    Separation s = compare(a.piece(i), b.piece(j), between(i, j), phase_, beyond, touch_only);
    s.on_a += a.center(i);
    s.on_b += a.center(i);
    return s;
  }

 private:
  double bound(int i, int j) const {
    if (!a_.volume().bounded() || !b_.volume().bounded()) return halfSpaceBound(i, j);
    return lowerBound(a_.node(i).bounds, moved(b_.node(j).bounds, aMb_));
  }
  double halfSpaceBound(int i, int j) const {
    const Convex a = boxed(a_, i), b = boxed(b_, j);
    SE3<double> X = aMb_;
    if (b.core == Core::box) X.p = X.act(b_.node(j).bounds.center());
    if (a.core == Core::box) X.p -= a_.node(i).bounds.center();
    return separation(a, b, X, infinity, false).distance;
  }
  static Convex boxed(const Side& side, int i) {
    if (!side.volume().bounded()) return side.volume().piece(0);
    Convex c;
    c.core = Core::box;
    c.half = side.node(i).bounds.half();
    return c;
  }

  Side a_, b_;
  const SE3<double>& aMb_;
  const NarrowPhase& phase_;
};

}  // namespace

bool collide(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase) {
  if (a.empty() || b.empty()) return false;
  if (a.single() && b.single()) return compare(a.piece(0), b.piece(0), aMb, phase, 0, true).distance <= 0;
  bool hit = false;
  const Search search(a, b, aMb, phase);
  search.run(0, [&](int i, int j) {
    hit = search.pieces(i, j, 0, true).distance <= 0;
    return hit ? -infinity : 0;
  });
  return hit;
}

Separation nearest(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase, double beyond) {
  Separation best;
  best.distance = infinity;
  if (a.empty() || b.empty()) return best;
  if (a.single() && b.single()) return compare(a.piece(0), b.piece(0), aMb, phase, beyond, false);
  const Search search(a, b, aMb, phase);
  search.run(beyond, [&](int i, int j) {
    const Separation s = search.pieces(i, j, std::min(beyond, best.distance), false);
    if (s.distance < best.distance) best = s;
    return std::min(beyond, best.distance);
  });
  if (best.distance == infinity) best.distance = beyond;
  return best;
}

void askContacts(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase, double within,
                 bool (*found)(const void* context, const NearPieces& x), const void* context) {
  if (a.empty() || b.empty()) return;
  const Search search(a, b, aMb, phase);
  search.run(within, [&](int i, int j) {
    const Separation s = search.pieces(i, j, within, false);
    return s.distance > within || found(context, {a.piece(i), b.piece(j), {i, j}, a.center(i), search.between(i, j), s}) ? within : -infinity;
  });
}

}  // namespace dyn
