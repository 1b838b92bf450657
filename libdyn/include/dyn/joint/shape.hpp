// SPDX-License-Identifier: BSD-2-Clause
// The closed set of motion subspaces that the recursions know. A joint type declares one shape for each joint; behind the plugin interface the
// library sees shapes, never types.
#pragma once

#include <cstdint>

namespace dyn {

/// Each shape defines the `pose` components that a plugin writes for a joint, in this order, and the motion subspace S in the moving frame.
enum class Shape : std::int32_t {
  revolute,        ///< pose: cos, sin.          S = e6 (rotation about z)
  prismatic,       ///< pose: z.                 S = e3 (translation along z)
  spherical,       ///< pose: R (9, row-major).  S = [0; 1]
  translation,     ///< pose: p (3).             S = [1; 0], no rotation
  planar,          ///< pose: x, y, cos, sin.    S = (e1, e2, e6)
  free,            ///< pose: R (9), p (3).      S = identity
  dense_constant,  ///< pose: R (9), p (3).      S given once when the joint is prepared
  dense,           ///< pose: R (9), p (3); subspace: S (6 x nv, column after column); bias: (dS/dt) v
};

constexpr int max_joint_nv = 6;  ///< the largest number of degrees of freedom of a joint
constexpr int max_joint_nq = 7;  ///< the largest number of coordinates of a joint

/// Returns how many `pose` components a joint of this shape has.
constexpr int poseSize(Shape shape) {
  switch (shape) {
    case Shape::revolute:
      return 2;
    case Shape::prismatic:
      return 1;
    case Shape::spherical:
      return 9;
    case Shape::translation:
      return 3;
    case Shape::planar:
      return 4;
    default:
      return 12;
  }
}

/// Returns whether the motion subspace has no linear part.
constexpr bool turnsOnly(Shape shape) { return shape == Shape::revolute || shape == Shape::spherical; }

}  // namespace dyn
