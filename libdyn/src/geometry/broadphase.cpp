// SPDX-License-Identifier: BSD-2-Clause
// Only this source and narrow/fcl.cpp include FCL. They are compiled for the instruction set of Debian's FCL library, because the alignment of
// members of FCL's classes depends on it.
#include "geometry/broadphase.hpp"

#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision_object.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace dyn {

#if defined(__x86_64__)
static_assert(EIGEN_MAX_ALIGN_BYTES == 16, "FCL's headers must be compiled for the instruction set that its library was built for");
#endif

namespace {

fcl::AABBd boxOf(const Bounds& b) {
  // FCL halves the sum of two corners. Infinite corners would give NaN.
  constexpr double large = std::numeric_limits<double>::max() / 4;
  fcl::AABBd box;
  for (int i = 0; i < 3; ++i) {
    box.min_[i] = std::fmax(b.lower[i], -large);
    box.max_[i] = std::fmin(b.upper[i], large);
  }
  return box;
}

/// FCL's tree reads only the box of an object. We set this box ourselves, because ours is tighter around a rotated object.
class Box : public fcl::CollisionObjectd {
 public:
  explicit Box(int number) : fcl::CollisionObjectd(nullptr), number_(number) {
    // The tree reads the type of the shape, but not the shape, so all boxes share one. The constructor would write into it, so it is set here.
    static const std::shared_ptr<fcl::CollisionGeometryd> any = std::make_shared<fcl::Sphered>(1.0);
    cgeom = any;
    cgeom_const = any;
  }
  void place(const fcl::AABBd& box) { aabb = box; }
  int number() const { return number_; }

 private:
  int number_;
};

/// Number of an object of a tree. All objects of the trees are of class Box.
int numberOf(const fcl::CollisionObjectd* object) { return static_cast<const Box*>(object)->number(); }

}  // namespace

struct Broadphase::Tree {
  std::vector<std::unique_ptr<Box>> boxes;  ///< by number; null until a box is placed
  fcl::DynamicAABBTreeCollisionManagerd manager;
  bool registered = false;
};

Broadphase::Broadphase(int count) : tree_(std::make_unique<Tree>()) { tree_->boxes.resize(static_cast<std::size_t>(count)); }
Broadphase::~Broadphase() = default;

void Broadphase::place(int box, const Bounds& bounds) {
  std::unique_ptr<Box>& b = tree_->boxes[static_cast<std::size_t>(box)];
  if (!b) b = std::make_unique<Box>(box);
  b->place(boxOf(bounds));
}

void Broadphase::update() {
  if (tree_->registered) {
    tree_->manager.update();
    return;
  }
  std::vector<fcl::CollisionObjectd*> objects;
  for (const auto& box : tree_->boxes)
    if (box) objects.push_back(box.get());
  if (objects.empty()) return;
  tree_->manager.registerObjects(objects);
  tree_->manager.setup();
  tree_->registered = true;
}

namespace {
/// A function and its context, which FCL passes on as one pointer.
template <class Found>
struct Call {
  Found found;
  const void* context;
};
}  // namespace

void Broadphase::askMeeting(const Bounds& bounds, void (*found)(const void* context, int box), const void* context) const {
  Box asked(-1);
  asked.place(boxOf(bounds));
  Call<decltype(found)> call{found, context};
  tree_->manager.collide(&asked, &call, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    const auto& c = *static_cast<Call<decltype(found)>*>(data);
    c.found(c.context, std::max(numberOf(a), numberOf(b)));
    return false;  // continue the search
  });
}

void Broadphase::askPairs(void (*found)(const void* context, int a, int b), const void* context) const {
  Call<decltype(found)> call{found, context};
  tree_->manager.collide(&call, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data) {
    const auto& c = *static_cast<Call<decltype(found)>*>(data);
    c.found(c.context, numberOf(a), numberOf(b));
    return false;
  });
}

}  // namespace dyn
