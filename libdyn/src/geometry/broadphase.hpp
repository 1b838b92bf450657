// SPDX-License-Identifier: BSD-2-Clause
// Search for overlapping boxes in FCL's dynamic tree of axis-aligned boxes. The header hides FCL's types, because their layout depends on the
// compiler flags.
#pragma once

#include "geometry/volume.hpp"

#include <memory>

namespace dyn {

class Broadphase {
 public:
  /// Boxes are numbered from 0 to count - 1. A box that is not placed before the first update() is never found.
  explicit Broadphase(int count);
  ~Broadphase();
  Broadphase(const Broadphase&) = delete;
  Broadphase& operator=(const Broadphase&) = delete;

  void place(int box, const Bounds& bounds);
  /// Must be called after boxes have been placed and before a search.
  void update();

  /// Calls found(box) for each box that overlaps `bounds`.
  template <class Found>
  void meeting(const Bounds& bounds, const Found& found) const {
    askMeeting(
        bounds, [](const void* context, int box) { (*static_cast<const Found*>(context))(box); }, &found);
  }
  /// Calls found(a, b) for each two boxes that overlap.
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
