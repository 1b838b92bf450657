// Two volumes against each other: their convex pieces, those near one another found by going down both trees of boxes.
#pragma once

#include "geometry/volume.hpp"

namespace dyn {

// aMb is the pose of b in a; answers are in a. An empty volume is infinitely far.

bool collide(const Volume& a, const Volume& b, const SE3<double>& aMb);

/// The nearest two pieces, or those that overlap deepest. If none is nearer than `beyond`, the distance returned is at least that.
Separation nearest(const Volume& a, const Volume& b, const SE3<double>& aMb, double beyond);

/// Calls found(Separation) for each two pieces that share a point, until it returns false.
using Found = bool (*)(void* context, const Separation& s);
void contacts(const Volume& a, const Volume& b, const SE3<double>& aMb, Found found, void* context);

}  // namespace dyn
