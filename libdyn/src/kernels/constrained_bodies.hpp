// The bodies between constraints and the world, where the articulated-body recursion has left them: numbers, or a lane of packs each.
#pragma once

#include "compile/constraints.hpp"
#include "kernels/lanes.hpp"
#include "kernels/workspace.hpp"

namespace dyn::kernels {

template <class S>
double inLane(const S& x, int lane) {
  return reinterpret_cast<const double*>(&x)[lane];
}
template <class S>
Vec3<double> inLane(const Vec3<S>& x, int lane) {
  return {inLane(x.x, lane), inLane(x.y, lane), inLane(x.z, lane)};
}
template <class S>
Motion<double> inLane(const Motion<S>& x, int lane) {
  return {inLane(x.linear, lane), inLane(x.angular, lane)};
}
template <class S>
Force<double> inLane(const Force<S>& x, int lane) {
  return {inLane(x.linear, lane), inLane(x.angular, lane)};
}
template <class S>
Mat3<double> inLane(const Mat3<S>& x, int lane) {
  Mat3<double> out;
  for (int k = 0; k < 9; ++k) out.m[k] = inLane(x.m[k], lane);
  return out;
}

/// A degree of freedom. Numbers are read where they are asked for: a pack of one of them is a load.
template <class S>
struct ConstrainedDof {
  DofFactor<S>& dof;
  const Seat& seat;
  Motion<double> S_() const { return inLane(dof.S_, seat.lane); }
  Force<double> W() const { return inLane(dof.W, seat.lane); }
  double inverse() const { return inLane(dof.inverse, seat.lane); }
  double y() const { return inLane(dof.y, seat.lane); }
  /// All lanes at once: what is written number by number and read as a pack stalls the core.
  void setY(double y) const {
    if constexpr (lanes_of<S> == 1) {
      dof.y = y;
    } else {
      dof.y = select(lanes<S>(seat.lanes), S(y), dof.y);
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
    Seat seat;
    int nv() const { return index.nv; }
    bool isRoot() const { return index.parent == 0; }
    /// As the articulated-body recursion names it.
    bool isBareRoot() const { return index.flying_root && !all.m.roots_have_armature; }
    ConstrainedDof<S> dof(int k) const { return {all.w.dof[seat.strip_dof + k], seat}; }
    Mat3<double> R() const { return inLane(all.w.R[seat.strip], seat.lane); }
    Vec3<double> r() const { return inLane(all.w.r[seat.strip], seat.lane); }
    Vec3<double> w() const { return inLane(all.w.w[seat.strip], seat.lane); }
    Motion<double> acceleration() const { return inLane(all.w.acc[seat.strip], seat.lane); }
    Motion<double> beta() const { return inLane(all.w.beta[seat.strip], seat.lane); }
    /// Of a root: the aligned axes of its tree in the world, and where they are.
    SE3<double> tree() const {
      if (!index.flying_root) return {};
      const SE3<S>& rel = all.w.rel[seat.strip];
      return {inLane(rel.R, seat.lane), inLane(rel.p, seat.lane)};
    }
  };
  Body operator[](const ConstrainedBody& here) const {
    const BodyIndex& index = m.index[static_cast<std::size_t>(here.body)];
    if constexpr (lanes_of<S> == 1) {
      return {*this, index, {here.body, 0, 1, index.idx_v}};
    } else {
      return {*this, index, here.seat};
    }
  }
};

}  // namespace dyn::kernels
