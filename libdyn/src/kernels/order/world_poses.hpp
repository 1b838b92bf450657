// SPDX-License-Identifier: BSD-2-Clause
// Poses of bodies in the world.
#pragma once

#include "kernels/order/joint_frames.hpp"
#include "kernels/pack/pose_rows.hpp"

namespace dyn::kernels {

/// Whether body i's rotation in the world is orthonormalised. Poses turn no inertias, so it is enough that long chains do not drift.
template <class Order>
bool isOrthonormalised(const Order& order, int i) {
  return order.depth(i) % 16 == 0;
}

/// Pose of body i in the world, from its pose in its parent's frame.
template <class S, class Order>
SE3<S> placedInWorld(const Order& order, const Workspace<S>& w, const SE3<S>& rel, int i) {
  const SE3<S>& parent = order.parent(w.oM, i);
  return {isOrthonormalised(order, i) ? orthonormalised(parent.R * rel.R) : parent.R * rel.R, parent.act(rel.p)};
}

/// Copies number by number. Copying in blocks what was just written number by number would stall the core.
template <class S>
void store(const SE3<S>& from, SE3<S>& to) {
  for (int k = 0; k < 9; ++k) to.R.m[k] = from.R.m[k];
  for (int k = 0; k < 3; ++k) to.p[k] = from.p[k];
}

/// Whether bodies' poses in their parents' frames are wanted as well.
enum class Poses { in_world, in_parents_too };

/// Writes w.oM of body i, and w.rel if it is wanted, for recursions that need no velocities.
template <Poses poses, class S, class Joint, class Order>
void placeInWorld(const Joint& joint, const Order& order, int i, Workspace<S>& w) {
  const auto& placement = order.constants(i).placement;
  if constexpr (poses == Poses::in_world && Order::lanes_are_states && Joint::about_z) {
    const SE3<S>& parent = order.parent(w.oM, i);
    SE3<S> pose{{}, parent.p};
    withRotation(
        joint, order, i, [&] { return joint.rotate(placement.R); }, [&](const auto& R) { pose.R = parent.R * R; });
    alongOffset<S, Joint>(
        order, i, [&] { return placement.p; }, [&](const auto& r) { pose.p += parent.R * r; });
    if (isOrthonormalised(order, i)) pose.R = orthonormalised(pose.R);
    store(pose, w.oM[i]);
  } else if constexpr (std::is_same_v<S, double>) {
    const PoseRows rel = [&] {
      if constexpr (Joint::about_z) {
        return PoseRows::load(placement).turnZ(joint.c, joint.s);
      } else if constexpr (requires { joint.rotation(); }) {
        return (placement.R * PoseRows::of(joint.rotation(), joint.translation())).moved(placement.p);
      } else {
        const SE3<S> pose = placedInParent<S>(joint, placement);
        return PoseRows::of(pose.R, pose.p);
      }
    }();
    const SE3<S>& parent = order.parent(w.oM, i);
    rel.store(w.rel[i]);
    (parent.R * rel).store(parent.p, w.oM[i]);
    if (isOrthonormalised(order, i)) w.oM[i].R = orthonormalised(w.oM[i].R);
  } else {
    const SE3<S> rel = placedInParent<S>(joint, placement);
    store(rel, w.rel[i]);
    store(placedInWorld(order, w, rel, i), w.oM[i]);
  }
}

}  // namespace dyn::kernels
