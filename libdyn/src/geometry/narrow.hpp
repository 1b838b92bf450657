// Two volumes against each other: their convex pieces, those near one another found by going down both trees of boxes.
#pragma once

#include "geometry/volume.hpp"

namespace dyn {

// aMb is the pose of b in a; answers are in a. An empty volume is infinitely far.

bool collide(const Volume& a, const Volume& b, const SE3<double>& aMb);

/// The nearest two pieces, or those that overlap deepest. If none is nearer than `beyond`, the distance returned is at least that.
Separation nearest(const Volume& a, const Volume& b, const SE3<double>& aMb, double beyond);

/// Calls found(s) for each two pieces that share a point, until it returns false.
void askContacts(const Volume& a, const Volume& b, const SE3<double>& aMb, bool (*found)(const void* context, const Separation& s),
                 const void* context);
template <class Found>
void contacts(const Volume& a, const Volume& b, const SE3<double>& aMb, const Found& found) {
  askContacts(
      a, b, aMb, [](const void* context, const Separation& s) { return (*static_cast<const Found*>(context))(s); }, &found);
}

}  // namespace dyn
