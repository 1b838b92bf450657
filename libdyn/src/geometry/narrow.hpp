// Two volumes against each other: their convex pieces, those near one another found by going down both trees of boxes.
#pragma once

#include "geometry/volume.hpp"

namespace dyn {

// aMb is the pose of b in a; answers are in a. An empty volume is infinitely far.

bool collide(const Volume& a, const Volume& b, const SE3<double>& aMb);

/// The nearest two pieces, or those that overlap deepest. If none is nearer than `beyond`, the distance returned is at least that.
Separation nearest(const Volume& a, const Volume& b, const SE3<double>& aMb, double beyond);

/// Two pieces, in a's frame but for their own: pose of the one that is a's, of b's in a's piece, and their separation as nearest() gives it.
struct NearPieces {
  const Convex &a, &b;
  int number[2];        ///< among their volumes' pieces
  Vec3<double> center;  ///< of a's piece
  SE3<double> aMb;      ///< from b's piece to a's
  Separation s;         ///< in a's volume
};

/// Calls found(pieces) for each two pieces that are no farther apart than `within`, until it returns false.
void askContacts(const Volume& a, const Volume& b, const SE3<double>& aMb, double within, bool (*found)(const void* context, const NearPieces& x),
                 const void* context);
template <class Found>
void contacts(const Volume& a, const Volume& b, const SE3<double>& aMb, double within, const Found& found) {
  askContacts(
      a, b, aMb, within, [](const void* context, const NearPieces& x) { return (*static_cast<const Found*>(context))(x); }, &found);
}

}  // namespace dyn
