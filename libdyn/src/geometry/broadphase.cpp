// The one source that includes FCL, compiled for the instruction set that Debian's library is compiled for: FCL's classes have members whose
// alignment follows from it.
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
  // FCL halves sums of corners; infinite ones would become NaN.
  constexpr double large = std::numeric_limits<double>::max() / 4;
  fcl::AABBd box;
  for (int i = 0; i < 3; ++i) {
    box.min_[i] = std::fmax(b.lower[i], -large);
    box.max_[i] = std::fmin(b.upper[i], large);
  }
  return box;
}

/// FCL's tree asks an object for nothing but its box, which we set ourselves: around a turned object ours is smaller.
class Box : public fcl::CollisionObjectd {
 public:
  explicit Box(int number) : fcl::CollisionObjectd(nullptr), number_(number) {
    // The tree asks for the kind of shape, but not for the shape. All share one, set past the constructor, which would write into it.
    static const std::shared_ptr<fcl::CollisionGeometryd> any = std::make_shared<fcl::Sphered>(1.0);
    cgeom = any;
    cgeom_const = any;
  }
  void place(const fcl::AABBd& box) { aabb = box; }
  int number() const { return number_; }

 private:
  int number_;
};

/// All objects of the trees are boxes.
int numberOf(const fcl::CollisionObjectd* object) { return static_cast<const Box*>(object)->number(); }

}  // namespace

struct Broadphase::Tree {
  std::vector<std::unique_ptr<Box>> boxes;  ///< by number, null before they are placed
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
/// A function and what it was made of, for FCL to carry.
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
    return false;  // goes on
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
