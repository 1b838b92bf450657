// SPDX-License-Identifier: BSD-2-Clause
// Contacts of a simulation, found from the volumes on its bodies.
#pragma once

#include <dyn/geometry/geometry_model.hpp>
#include <dyn/integrate/contacts.hpp>

#include <vector>

namespace dyn {

/// Friction between two geometries, or between all geometries of two bodies.
struct PairFriction {
  PairName names;       ///< of the two geometries or bodies, in any order
  double friction = 0;  ///< coefficient
};

/// How geometryContacts() reports contacts.
struct GeometryContactOptions {
  double friction = 0.8;                 ///< coefficient of pairs that `pairs` does not name
  std::vector<PairFriction> pairs = {};  ///< friction of single pairs; later entries win
  double margin = 0.01;                  ///< [m] volumes farther apart are reported only if they may meet within the step
};

/// Makes a finder of the contacts of all pairs of `geometry`. Two solids that face each other give the corners of the region they share (of faces,
/// sides and rims), not only their nearest points. Pairs with meshes or voxels give at most eight contacts. Throws Error(argument) for a margin or
/// friction that is negative or not finite, and for names that no pair has. Use in one thread only: copies share their scratch memory.
///
///     simulator.setContacts(dyn::geometryContacts(model, dyn::compileGeometry(model, description), {.friction = 0.6}));
DYN_API ContactFinder geometryContacts(const CompactModel& model, const GeometryModel& geometry, const GeometryContactOptions& options = {});

}  // namespace dyn
