// Aligned frames: the axes of the tree's root body (of the world, when the root does not fly) with the origin at each joint.
//
// Inertias are rotated once, shifts from joint to joint are pure translations formed as R_parent * p_local, and no world position
// enters: results stay exact however far the base stands from the origin.
#pragma once

#include "kernels/sweep.hpp"

namespace dyn::kernels {

/// A free body on the world carries its own axes: R = 1 there, and the world's directions are turned instead.
template <class Joint>
bool isFlyingRoot(int parent) {
  return Joint::is_free && parent == 0;
}

/// Writes d.rel, d.R and d.r of body i.
template <class Joint>
void placeAligned(const Joint& joint, const SE3<double>& placement, int i, const BodyIndex& index, DataImpl& d) {
  placeInParent(joint, placement, d.rel[i]);
  if (isFlyingRoot<Joint>(index.parent)) {
    d.R[i] = Mat3<double>::identity();
    d.r[i] = {};
  } else {
    d.R[i] = composedRotation(d.R[index.parent], d.rel[i].R, index.depth);
    d.r[i] = d.R[index.parent] * d.rel[i].p;
  }
}

/// Column k of the motion subspace in aligned axes.
template <class Joint>
Motion<double> alignedColumn(const Joint& joint, int k, const Mat3<double>& R) {
  const Motion<double> s = joint.column(k);
  Motion<double> out;
  if constexpr (Joint::has_linear) out.linear = R * s.linear;
  if constexpr (Joint::has_angular) out.angular = R * s.angular;
  return out;
}

}  // namespace dyn::kernels
