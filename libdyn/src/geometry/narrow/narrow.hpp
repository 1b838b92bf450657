// SPDX-License-Identifier: BSD-2-Clause
// Collision and distance of two volumes. A descent of both trees of boxes finds the convex pieces that are near each other.
#pragma once

#include "geometry/volume.hpp"

#include <dyn/geometry/geometry_model.hpp>

namespace dyn {

/// The functions that compare two pieces.
struct NarrowPhase {
  GeometryOptions::Narrow functions = GeometryOptions::Narrow::own;
  double fcl_tolerance = 0;  ///< [m]
};

// aMb is the pose of b in a; results are in the frame of a. An empty volume is infinitely far from any other. FCL's functions may
// throw FclFailure, and know no half-spaces.

bool collide(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase);

/// Returns the separation of the nearest two pieces, or of the two that overlap deepest. If none are nearer than `beyond`, the returned distance is
/// at least `beyond`.
Separation nearest(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase, double beyond);

/// Two pieces that are near each other. Each piece is in its own frame.
struct NearPieces {
  const Convex &a, &b;
  int number[2];        ///< indices of the pieces in their volumes
  Vec3<double> center;  ///< position of a's piece in a
  SE3<double> aMb;      ///< pose of b's piece in a's piece
  Separation s;         ///< in the frame of a, as nearest() returns it
};

/// Calls found(pieces) for each two pieces that are no farther apart than `within`, until the call returns false.
void askContacts(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase, double within,
                 bool (*found)(const void* context, const NearPieces& x), const void* context);
template <class Found>
void contacts(const Volume& a, const Volume& b, const SE3<double>& aMb, const NarrowPhase& phase, double within, const Found& found) {
  askContacts(
      a, b, aMb, phase, within, [](const void* context, const NearPieces& x) { return (*static_cast<const Found*>(context))(x); }, &found);
}

}  // namespace dyn
