// Poses, velocities and accelerations, from the root outward.
#pragma once

#include "kernels/joint_frames.hpp"
#include "kernels/pose_rows.hpp"

namespace dyn::kernels {

/// By how much a point of a body accelerates beyond the body's origin.
template <class S>
Vec3<S> beyondOrigin(const Vec3<S>& angular, const Vec3<S>& w, const Vec3<S>& point) {
  return cross(angular, point) + cross(w, cross(w, point));
}

/// Whether body i's rotation in the world is brought back to the rotations. Poses have no inertias to turn: it is enough that long chains do
/// not drift.
template <class Order>
bool isRenewed(const Order& order, int i) {
  return order.depth(i) % 16 == 0;
}

/// Pose in the world of body i from that in its parent's frame.
template <class S, class Order>
SE3<S> placedInWorld(const Order& order, const Workspace<S>& w, const SE3<S>& rel, int i) {
  const SE3<S>& parent = order.parent(w.oM, i);
  return {isRenewed(order, i) ? renewed(parent.R * rel.R) : parent.R * rel.R, parent.act(rel.p)};
}

/// Number by number: what was just made that way stalls the core when it is copied in blocks.
template <class S>
void store(const SE3<S>& from, SE3<S>& to) {
  for (int k = 0; k < 9; ++k) to.R.m[k] = from.R.m[k];
  for (int k = 0; k < 3; ++k) to.p[k] = from.p[k];
}

/// Whether bodies' poses in their parents' frames are wanted as well.
enum class Poses { in_world, in_parents_too };

/// w.oM of body i, and w.rel if that is wanted, where nothing else is to be made of them.
template <Poses poses, class S, class Joint, class Order>
void placeInWorld(const Joint& joint, const Order& order, int i, Workspace<S>& w) {
  const auto& placement = order.constants(i).placement;
  if constexpr (poses == Poses::in_world && Order::alike && lanes_of<S> > 1 && Joint::about_z) {
    const SE3<S>& parent = order.parent(w.oM, i);
    SE3<S> pose{{}, parent.p};
    withRotation(
        joint, order, i, [&] { return joint.rotate(placement.R); }, [&](const auto& R) { pose.R = parent.R * R; });
    alongLever<S, Joint>(
        order, i, [&] { return placement.p; }, [&](const auto& r) { pose.p += parent.R * r; });
    if (isRenewed(order, i)) pose.R = renewed(pose.R);
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
    if (isRenewed(order, i)) w.oM[i].R = renewed(w.oM[i].R);
  } else {
    const SE3<S> rel = placedInParent<S>(joint, placement);
    store(rel, w.rel[i]);
    store(placedInWorld(order, w, rel, i), w.oM[i]);
  }
}

/// w.oM, and w.rel if that is wanted; with v both, and w.v; with a, w.a, and w.sliding if it is there. Of spatial accelerations w x v is a part,
/// whose rounding would stay where the origin's own are wanted: those are summed up from w.sliding, see originAcceleration().
template <Poses poses = Poses::in_parents_too, class S, class Order>
void forwardKinematics(const Order& order, Workspace<S>& w, const S* v, const S* a) {
  w.v[0] = w.a[0] = {};
  order.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    if (!v) return placeInWorld<poses>(joint, order, i, w);
    const SE3<S> rel = placedInParent<S>(joint, order.constants(i).placement);
    w.rel[i] = rel;
    w.oM[i] = placedInWorld(order, w, rel, i);
    const Motion<S> s = joint.times(v + iv);
    const Motion<S> carried = rel.actInv(order.parent(w.v, i));
    w.v[i] = carried + s;
    if (!a) return;
    Motion<S> ds = joint.times(a + iv);
    if constexpr (Joint::has_bias) ds += joint.bias();
    // Hinges do not slide.
    if constexpr (!Joint::about_z) {
      if (w.sliding) w.sliding[i] = ds.linear + cross(carried.angular + carried.angular + s.angular, s.linear);
    }
    w.a[i] = rel.actInv(order.parent(w.a, i)) + (ds + carried.cross(s));
  });
}

}  // namespace dyn::kernels
