// SPDX-License-Identifier: BSD-2-Clause
// A body's own elements: <inertial> and its joints.
#pragma once

#include "geom.hpp"

#include <dyn/model/joint_description.hpp>

namespace dyn::mjcf {

/// Returns the inertia of an <inertial> in the body's frame. Throws Error(syntax | model) for missing or contradictory values, and for an inertia
/// that is not positive semi-definite, unless `inertias` is any; then it is noted.
Inertia<long double> readInertial(const Values& values, const SE3<long double>& frame, Inertias inertias, const Context& context);

/// Returns an inertia with at least the mass and the principal moments of the settings, and balanced if they say so.
Inertia<long double> bounded(const Inertia<long double>& inertia, const Settings& settings);

struct Joint {
  JointDescription description;  ///< all but its place; nameless if the file gives no name
  bool free = false;             ///< a free joint, whose q is the body's pose in the world
  double ref = 0;                ///< q where the file puts the body; of hinges and slides
  SE3<long double> pose;         ///< of the joint's frame at q = 0, with the body where the file puts it, in the body's frame
  SE3<long double> after;        ///< of the body's frame in the joint's moving frame
};

/// Reads a <joint> or <freejoint>. `frame` is the pose of its surroundings in the body's frame. The joint is turned or shifted by `ref`, so that its
/// q is MuJoCo's qpos. Throws Error(syntax | model) for types, axes, ranges and damping that MuJoCo does not have.
Joint readJoint(const Values& values, const SE3<long double>& frame, const Context& context);

}  // namespace dyn::mjcf
