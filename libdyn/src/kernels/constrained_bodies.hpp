// The bodies between constraints and the world, where the articulated-body recursion has left them: numbers, or a lane of packs each.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/lanes.hpp"
#include "kernels/workspace.hpp"

namespace dyn::kernels {

// What one lane has: as numbers, or as packs P of it, which memory gives to all lanes at once where they are asked for.

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

/// A degree of freedom. Numbers are read where they are asked for.
template <class S>
struct ConstrainedDof {
  DofFactor<S>& dof;
  int lane;
  unsigned lanes;  ///< that show it
  template <class P = double>
  Motion<P> S_() const {
    return inLane<P>(dof.S_, lane);
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
  /// All lanes at once: what is written number by number and read as a pack stalls the core.
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
    int strip, lane, strip_dof;
    unsigned lanes;
    int nv() const { return index.nv; }
    bool isRoot() const { return index.parent == 0; }
    /// As the articulated-body recursion names it.
    bool isBareRoot() const { return index.flying_root && !all.m.roots_have_armature; }
    ConstrainedDof<S> dof(int k) const { return {all.w.dof[strip_dof + k], lane, lanes}; }
    Mat3<double> R() const { return inLane(all.w.R[strip], lane); }
    template <class P = double>
    Vec3<P> r() const {
      return inLane<P>(all.w.r[strip], lane);
    }
    Vec3<double> w() const { return inLane(all.w.w[strip], lane); }
    Motion<double> acceleration() const { return inLane(all.w.acc[strip], lane); }
    template <class P>
    Motion<P> beta() const {
      return inLane<P>(all.w.beta[strip], lane);
    }
    /// Of a root: the aligned axes of its tree in the world, and where they are.
    SE3<double> tree() const {
      if (!index.flying_root) return {};
      const SE3<S>& rel = all.w.rel[strip];
      return {inLane(rel.R, lane), inLane(rel.p, lane)};
    }
  };
  Body operator[](const ConstrainedBody& here) const {
    const BodyIndex& index = m.index[static_cast<std::size_t>(here.body)];
    if constexpr (lanes_of<S> == 1) {
      return {*this, index, here.body, 0, index.idx_v, 1};
    } else {
      return {*this, index, here.seat.strip, here.seat.lane, here.seat.strip_dof, here.seat.lanes};
    }
  }
};

}  // namespace dyn::kernels
