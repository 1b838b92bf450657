// Jacobians: of all joints at once in the world, or of one frame, from it to the root.
#pragma once

#include "kernels/kinematics.hpp"

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

/// w.oM, of a single state w.rel, and each joint's columns in the world, about its origin: 6 numbers a degree of freedom.
template <class S, class Order>
void jointJacobians(const Order& bodies, Workspace<S>& w, S* J) {
  bodies.forward(passing(), [&]<class Joint>(const Joint& joint, int i, int iv) {
    placeInWorld<lanes_of<S> == 1 ? Poses::in_parents_too : Poses::in_world>(joint, bodies, i, w);
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

/// Walks from a frame to the world, joint by joint. At each joint: the frame's origin x as seen from the moving body, the rotation Q
/// from the body's axes into the frame's, and their rates. Everything is local, so the base's distance does not matter.
template <class S>
struct Walk {
  Mat3<S> Q;       ///< frame axes from body axes
  Vec3<S> x;       ///< frame origin in body axes
  Motion<S> rate;  ///< velocity of the frame relative to the body: of its origin, and angular, body axes
};

/// Columns of one joint seen from the frame: s moved to the frame's origin.
template <class S>
Motion<S> seen(const Walk<S>& walk, const Motion<S>& s) {
  return {walk.Q * (s.linear + cross(s.angular, walk.x)), walk.Q * s.angular};
}

/// Calls column(i, k, s) for each degree of freedom k that moves the frame, from it to the world: s is its column on body i. With v, the
/// walk's rates are kept.
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

/// J of a frame, 6 numbers a degree of freedom, `stride` apart, from w.rel and w.oM.
template <class S>
void frameJacobian(const Bodies<S>& bodies, const Workspace<S>& w, const FramePoint<S>& frame, ReferenceFrame reference, S* J,
                   std::ptrdiff_t stride) {
  for (int k = 0; k < bodies.m.nvx; ++k) std::fill_n(J + k * stride, 6, S(0));
  Walk<S> walk;
  // Each reference has one chain of rotations between the joint and where the column is expressed, never two.
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
