// SPDX-License-Identifier: BSD-2-Clause
// Access to the bodies between constraints and the world in the memory of the articulated-body recursion: as numbers, or as a lane of packs.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/body/workspace.hpp"
#include "kernels/pack/lanes.hpp"

#include <type_traits>

namespace dyn::kernels {

// The value of one lane, as a number, or as a pack P with this number in all lanes, to which the load from memory broadcasts it. If x has the type N
// of the constraints' own numbers, it is the value itself.

template <class N, class P = N, class S>
P inLane(const S& x, int lane) {
  if constexpr (std::is_same_v<N, S>) {
    return P(x);
  } else {
    return P(reinterpret_cast<const N*>(&x)[lane]);
  }
}
template <class N, class P = N, class S>
Vec3<P> inLane(const Vec3<S>& x, int lane) {
  return {inLane<N, P>(x.x, lane), inLane<N, P>(x.y, lane), inLane<N, P>(x.z, lane)};
}
template <class N, class P = N, class S>
Motion<P> inLane(const Motion<S>& x, int lane) {
  return {inLane<N, P>(x.linear, lane), inLane<N, P>(x.angular, lane)};
}
template <class N, class P = N, class S>
Force<P> inLane(const Force<S>& x, int lane) {
  return {inLane<N, P>(x.linear, lane), inLane<N, P>(x.angular, lane)};
}
template <class N, class S>
Mat3<N> inLane(const Mat3<S>& x, int lane) {
  Mat3<N> out;
  for (int k = 0; k < 9; ++k) out.m[k] = inLane<N>(x.m[k], lane);
  return out;
}

/// A degree of freedom of one of these bodies. Each member function reads its numbers from memory.
template <class S, class N>
struct ConstrainedDof {
  DofFactor<S>& dof;
  int lane;
  unsigned lanes;  ///< a bit for each lane that holds this body (a mirrored body is in several)
  template <class P = N>
  Motion<P> column() const {
    return inLane<N, P>(dof.column, lane);
  }
  template <class P = N>
  Force<P> W() const {
    return inLane<N, P>(dof.W, lane);
  }
  template <class P = N>
  P inverse() const {
    return inLane<N, P>(dof.inverse, lane);
  }
  N y() const { return inLane<N>(dof.y, lane); }
  /// Writes all lanes at once: reading a pack soon after its numbers were written one by one stalls the core.
  void setY(double y) const {
    if constexpr (lanes_of<S> == 1) {
      dof.y = y;
    } else {
      dof.y = select(kernels::lanes<S>(lanes), S(y), dof.y);
    }
  }
};

/// S is the scalar of the recursion, N the constraints' own numbers: doubles, which lane groups hold in lanes of S, or S itself for packs of states.
template <class S, class N = double>
struct ConstrainedBodies {
  using Number = N;
  static constexpr bool in_lane_groups = !std::is_same_v<S, N>;
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
    ConstrainedDof<S, N> dof(int k) const { return {all.w.dof[group_dof + k], lane, lanes}; }
    Mat3<N> R() const { return inLane<N>(all.w.R[group], lane); }
    template <class P = N>
    Vec3<P> r() const {
      return inLane<N, P>(all.w.r[group], lane);
    }
    Vec3<N> w() const { return inLane<N>(all.w.w[group], lane); }
    Motion<N> acceleration() const { return inLane<N>(all.w.acc[group], lane); }
    template <class P>
    Motion<P> beta() const {
      return inLane<N, P>(all.w.beta[group], lane);
    }
    /// For a root: the pose of its tree's aligned frame in the world.
    SE3<N> tree() const {
      if (!index.floating_base) return {};
      const SE3<S>& rel = all.w.rel[group];
      return {inLane<N>(rel.R, lane), inLane<N>(rel.p, lane)};
    }
  };
  Body operator[](const ConstrainedBody& here) const {
    const BodyIndex& index = m.index[static_cast<std::size_t>(here.body)];
    if constexpr (!in_lane_groups) {
      return {*this, index, here.body, 0, index.idx_v, 1};
    } else {
      return {*this, index, here.lane_slot.group, here.lane_slot.lane, here.lane_slot.group_dof, here.lane_slot.lanes};
    }
  }
};

}  // namespace dyn::kernels
