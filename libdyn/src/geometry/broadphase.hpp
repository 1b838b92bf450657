// Which boxes meet which: FCL's dynamic tree of axis-aligned boxes. Nothing of FCL is seen from outside: its types change with the flags that
// they are compiled with.
#pragma once

#include "geometry/volume.hpp"

#include <memory>

namespace dyn {

class Broadphase {
 public:
  /// Boxes numbered from 0 to count - 1. Those that are not placed before the first update() are never found.
  explicit Broadphase(int count);
  ~Broadphase();
  Broadphase(const Broadphase&) = delete;
  Broadphase& operator=(const Broadphase&) = delete;

  void place(int box, const Bounds& bounds);
  /// After boxes have been placed, before they are looked for.
  void update();

  /// Calls found(context, box) for each box that meets `bounds`; stops when it returns false.
  using Found = bool (*)(void* context, int box);
  void meeting(const Bounds& bounds, Found found, void* context) const;
  /// Calls found(context, a, b) for each two boxes that meet.
  using FoundPair = bool (*)(void* context, int a, int b);
  void pairs(FoundPair found, void* context) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace dyn
