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

  /// Calls found(box) for each box that meets `bounds`.
  template <class Found>
  void meeting(const Bounds& bounds, const Found& found) const {
    askMeeting(
        bounds, [](const void* context, int box) { (*static_cast<const Found*>(context))(box); }, &found);
  }
  /// Calls found(a, b) for each two boxes that meet.
  template <class Found>
  void pairs(const Found& found) const {
    askPairs([](const void* context, int a, int b) { (*static_cast<const Found*>(context))(a, b); }, &found);
  }

 private:
  void askMeeting(const Bounds& bounds, void (*found)(const void* context, int box), const void* context) const;
  void askPairs(void (*found)(const void* context, int a, int b), const void* context) const;

  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace dyn
