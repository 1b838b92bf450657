// SPDX-License-Identifier: BSD-2-Clause
// The differences between two descriptions.
#pragma once

#include <dyn/model/model.hpp>

#include <limits>
#include <string>
#include <vector>

namespace dyn {

/// One difference between two models, A and B.
struct Difference {
  std::string
      topic{},  ///< model, structure, joint, placement, inertia, limits, dissipation, coupling, frame, volume, constraint, collision, group or state
      name{},   ///< name of the body, joint, frame, volume, ...
      what{},   ///< what differs there, such as "mass" or "type"
      a{},      ///< its value in A; "-" if A does not have it
      b{};      ///< its value in B; "-" if B does not have it
  double size = std::numeric_limits<double>::infinity();  ///< how far apart the numbers are; infinite where that is no number
  std::string unit{};                                     ///< of `size`: m, rad, or 1 for a fraction of the larger value
};

/// Returns the differences of two descriptions, whose parts have the same names. Positions [m] and rotations [rad] differ if they are more than
/// `tolerance` apart. Masses, inertias, limits and parameters differ if they are apart by more than this fraction of the larger value. Limits that
/// are infinite or missing, and damping that is zero or missing, are the same. The order of bodies, the notes and the places in files do not matter.
/// Throws Error(model) for a model whose indices are out of range. O(n log n).
DYN_API std::vector<Difference> differences(const Model& a, const Model& b, double tolerance = 1e-9);

}  // namespace dyn
