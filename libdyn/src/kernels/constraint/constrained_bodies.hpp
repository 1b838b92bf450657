// SPDX-License-Identifier: BSD-2-Clause
// Access to the bodies between constraints and the world in the memory of the articulated-body recursion: as numbers, or as a lane of packs.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/body/workspace.hpp"
#include "kernels/pack/lanes.hpp"

namespace dyn::kernels {

// The value of one lane, as a number, or as a pack P with this number in all lanes, to which the load from memory broadcasts it.

template <class P = double, class S>
P inLane(const S& x, int lane) {
  return P(reinterpret_cast<const double*>(&x)[lane]);
}
template <class P = double, class S>
Vec3<P> inLane(const Vec3<S>& x, int lane) {
  return {inLane<P>(x.x, lane), inLane<P>(x.y, lane), inLane<P>(x.z, lane)};
}
template <class P = double, class S>
Motion<P> inLane(const Motion<S>& x, int lane) {
  return {inLane<P>(x.linear, lane), inLane<P>(x.angular, lane)};
}
template <class P = double, class S>
Force<P> inLane(const Force<S>& x, int lane) {
  return {inLane<P>(x.linear, lane), inLane<P>(x.angular, lane)};
}
template <class S>
Mat3<double> inLane(const Mat3<S>& x, int lane) {
  Mat3<double> out;
  for (int k = 0; k < 9; ++k) out.m[k] = inLane(x.m[k], lane);
  return out;
}

/// A degree of freedom of one of these bodies. Each member function reads its numbers from memory.
template <class S>
struct ConstrainedDof {
  DofFactor<S>& dof;
  int lane;
  unsigned lanes;  ///< a bit for each lane that holds this body (a mirrored body is in several)
  template <class P = double>
  Motion<P> column() const {
    return inLane<P>(dof.column, lane);
  }
  template <class P = double>
  Force<P> W() const {
    return inLane<P>(dof.W, lane);
  }
  template <class P = double>
  P inverse() const {
    return inLane<P>(dof.inverse, lane);
  }
  double y() const { return inLane(dof.y, lane); }
  /// Writes all lanes at once: reading a pack soon after its numbers were written one by one stalls the core.
  void setY(double y) const {
    if constexpr (lanes_of<S> == 1) {
      dof.y = y;
    } else {
      dof.y = select(kernels::lanes<S>(lanes), S(y), dof.y);
    }
  }
};

template <class S>
struct ConstrainedBodies {
  const CompactImpl& m;
  Workspace<S>& w;

  struct Body {
    const ConstrainedBodies& all;
    const BodyIndex& index;
    int group, lane, group_dof;
    unsigned lanes;
    int nv() const { return index.nv; }
    bool isRoot() const { return index.parent == 0; }
    /// The same as isPlainFloatingBase() of the articulated-body recursion.
    bool isPlainFloatingBase() const { return index.floating_base && !all.m.roots_have_armature; }
    ConstrainedDof<S> dof(int k) const { return {all.w.dof[group_dof + k], lane, lanes}; }
    Mat3<double> R() const { return inLane(all.w.R[group], lane); }
    template <class P = double>
    Vec3<P> r() const {
      return inLane<P>(all.w.r[group], lane);
    }
    Vec3<double> w() const { return inLane(all.w.w[group], lane); }
    Motion<double> acceleration() const { return inLane(all.w.acc[group], lane); }
    template <class P>
    Motion<P> beta() const {
      return inLane<P>(all.w.beta[group], lane);
    }
    /// For a root: the pose of its tree's aligned frame in the world.
    SE3<double> tree() const {
      if (!index.floating_base) return {};
      const SE3<S>& rel = all.w.rel[group];
      return {inLane(rel.R, lane), inLane(rel.p, lane)};
    }
  };
  Body operator[](const ConstrainedBody& here) const {
    const BodyIndex& index = m.index[static_cast<std::size_t>(here.body)];
    if constexpr (lanes_of<S> == 1) {
      return {*this, index, here.body, 0, index.idx_v, 1};
    } else {
      return {*this, index, here.lane_slot.group, here.lane_slot.lane, here.lane_slot.group_dof, here.lane_slot.lanes};
    }
  }
};

}  // namespace dyn::kernels
