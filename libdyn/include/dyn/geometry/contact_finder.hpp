// What touches in a simulation by the volumes that its bodies carry.
//
//   simulator.setContacts(dyn::geometryContacts(model, dyn::compileGeometry(model, description), {.friction = 0.6}));
#pragma once

#include <dyn/geometry/geometry_model.hpp>
#include <dyn/integrate/contacts.hpp>

#include <vector>

namespace dyn {

/// Of two geometries, or of all geometries of two bodies.
struct PairFriction {
  PairName names;
  double friction = 0;
};

struct GeometryContactOptions {
  double friction = 0.8;                 ///< coefficient, of pairs that `pairs` does not name
  std::vector<PairFriction> pairs = {};  ///< later ones win
  double margin = 0.01;                  ///< [m] volumes farther apart are told of only where they may come together within the step
};

/// Contacts of all pairs of `geometry`: where two solids face each other the corners of what they share, of faces, sides and rims, not their
/// nearest points alone. Of meshes and voxels no more than eight a pair. Throws Error(argument) for a margin or friction that is negative
/// or not finite, and for names that no pair has. For one thread: copies share their scratch.
DYN_API ContactFinder geometryContacts(const CompactModel& model, const GeometryModel& geometry, const GeometryContactOptions& options = {});

}  // namespace dyn
