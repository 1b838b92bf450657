// SPDX-License-Identifier: BSD-2-Clause
// Jacobians of all joints at once in the world, or of one frame, from the frame to the root.
#pragma once

#include "kernels/recursion/kinematics.hpp"

#include <dyn/spatial/reference_frame.hpp>

#include <algorithm>

namespace dyn::kernels {

template <class S>
void writeMotion(const Motion<S>& c, S* out) {
  for (int r = 0; r < 3; ++r) {
    out[r] = c.linear[r];
    out[3 + r] = c.angular[r];
  }
}

/// Writes w.oM, for single states also w.rel, and each joint's columns in world axes about the world's origin, 6 numbers per degree of freedom.
template <class S, BodyOrder Order>
void jointJacobians(const Order& bodies, Workspace<S>& w, S* J) {
  bodies.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    placeInWorld<Order::lanes_are_states ? Poses::in_world : Poses::in_parents_too>(joint, bodies, i, w);
    const SE3<S>& oM = w.oM[i];
    for (int k = 0; k < nvOf(joint); ++k) {
      Motion<S> column = joint.columnIn(oM.R, k);
      if constexpr (Joint::has_angular && Joint::has_linear) {
        column.linear += cross(oM.p, column.angular);
      } else if constexpr (Joint::has_angular) {
        column.linear = cross(oM.p, column.angular);
      }
      writeMotion(column, J + 6 * (iv + k));
    }
  });
}

/// A frame fixed to a body.
template <class S>
struct FramePoint {
  int body = 0;
  SE3<S> placement;  ///< in the body's frame
};

/// The state of a walk from a frame to the world, joint by joint. It describes the frame as seen from the body reached: origin, rotation and rates.
/// Everything is local, so the base's distance from the world's origin does not matter.
template <class S>
struct Walk {
  Mat3<S> Q;       ///< frame axes from body axes
  Vec3<S> x;       ///< frame origin in body axes
  Motion<S> rate;  ///< velocity of the frame relative to the body, linear at the frame's origin, body axes
};

/// A joint's column s, moved to the frame's origin, in the frame's axes.
template <class S>
Motion<S> seen(const Walk<S>& walk, const Motion<S>& s) {
  return {walk.Q * (s.linear + cross(s.angular, walk.x)), walk.Q * s.angular};
}

/// Calls column(i, k, s) for each degree of freedom that moves the frame, from the frame to the world. It is the k-th of body i, and s is its column
/// there. With v, walk.rate is computed as well.
template <class S, class Column>
void walkSupports(const Bodies<S>& bodies, const Workspace<S>& w, const FramePoint<S>& frame, const S* v, Walk<S>& walk, Column&& column) {
  const CompactImpl& m = bodies.m;
  walk = {transpose(frame.placement.R), frame.placement.p, {}};
  for (int i = frame.body; i > 0; i = bodies.parentOf(i)) {
    const BodyIndex& x = bodies.index(i);
    const TypeBatch& batch = m.batches[static_cast<std::size_t>(x.batch)];
    const Run here{batch.shape, batch.nv, i, 1, x.batch, x.slot};
    withShape<S>(batch.shape, batch.nv, [&]<class Joint>() {
      const Slot<S> slot = bodies.slotOf(here, 0);
      const Joint joint(slot);
      for (int k = 0; k < nvOf(joint); ++k) column(i, k, joint.column(k));
      const SE3<S>& rel = w.rel[i];
      if (v) {
        const Motion<S> s = joint.times(v + x.idx_v);
        walk.rate = {rel.R * (s.linear + cross(s.angular, walk.x) + walk.rate.linear), rel.R * (s.angular + walk.rate.angular)};
      }
      walk.x = rel.act(walk.x);
      walk.Q = walk.Q * transpose(rel.R);
    });
  }
}

/// Computes J of a frame from w.rel and w.oM: columns of 6 numbers, one per degree of freedom, `stride` apart.
template <class S>
void frameJacobian(const Bodies<S>& bodies, const Workspace<S>& w, const FramePoint<S>& frame, ReferenceFrame reference, S* J,
                   std::ptrdiff_t stride) {
  for (int k = 0; k < bodies.m.nvx; ++k) std::fill_n(J + k * stride, 6, S(0));
  Walk<S> walk;
  // In each reference frame, one chain of rotations leads from the joint to the axes of the column, never two.
  walkSupports(bodies, w, frame, static_cast<const S*>(nullptr), walk, [&](int i, int k, const Motion<S>& s) {
    const SE3<S>& oM = w.oM[i];
    S* out = J + (bodies.index(i).idx_v + k) * stride;
    switch (reference) {
      case ReferenceFrame::LOCAL:
        return writeMotion(seen(walk, s), out);
      case ReferenceFrame::WORLD:
        return writeMotion(oM.act(s), out);
      case ReferenceFrame::LOCAL_WORLD_ALIGNED:
        return writeMotion(Motion<S>{oM.R * (s.linear + cross(s.angular, walk.x)), oM.R * s.angular}, out);
    }
  });
}

}  // namespace dyn::kernels
