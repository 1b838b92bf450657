// SPDX-License-Identifier: BSD-2-Clause
// Converts the components that a joint type writes to a transform and back. Only this file and the kernels' sparse forms know their order.
#pragma once

#include <dyn/joint/shape.hpp>
#include <dyn/spatial/se3.hpp>

namespace dyn {

/// Returns the core motion of a joint of this shape; `c` has poseSize(shape) components.
template <class S>
SE3<S> poseFromComponents(Shape shape, const S* c) {
  const S zero(0), one(1);
  SE3<S> core;
  switch (shape) {
    case Shape::revolute:
      core.R = {{c[0], -c[1], zero, c[1], c[0], zero, zero, zero, one}};
      break;
    case Shape::prismatic:
      core.p = {zero, zero, c[0]};
      break;
    case Shape::translation:
      core.p = {c[0], c[1], c[2]};
      break;
    case Shape::planar:
      core.R = {{c[2], -c[3], zero, c[3], c[2], zero, zero, zero, one}};
      core.p = {c[0], c[1], zero};
      break;
    default:
      for (int i = 0; i < 9; ++i) core.R.m[i] = c[i];
      if (shape != Shape::spherical) core.p = {c[9], c[10], c[11]};
  }
  return core;
}

/// Writes the components of a pose or of a derivative of one: this map is linear.
template <class S>
void componentsOfPose(Shape shape, const Mat3<S>& R, const Vec3<S>& p, S* c) {
  switch (shape) {
    case Shape::revolute:
      c[0] = R(0, 0);
      c[1] = R(1, 0);
      break;
    case Shape::prismatic:
      c[0] = p.z;
      break;
    case Shape::translation:
      for (int i = 0; i < 3; ++i) c[i] = p[i];
      break;
    case Shape::planar:
      c[0] = p.x;
      c[1] = p.y;
      c[2] = R(0, 0);
      c[3] = R(1, 0);
      break;
    default:
      for (int i = 0; i < 9; ++i) c[i] = R.m[i];
      if (shape == Shape::spherical) return;
      for (int i = 0; i < 3; ++i) c[9 + i] = p[i];
  }
}

}  // namespace dyn
