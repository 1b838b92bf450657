// SPDX-License-Identifier: BSD-2-Clause
// Rows of constraints between frames: their positions, rates and unit forces.
//
// A constraint's rows are side by side, the linear ones first: the numbers of up to three rows are one pack over directions. Packs are longer than
// that. They write zeros behind a constraint's rows, before the rows that follow are written. If the numbers are packs of states, rows come one by
// one.
#pragma once

#include "kernels/constraint/constrained_bodies.hpp"
#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/pack/row_packs.hpp"

#include <dyn/lie/so3.hpp>

#include <algorithm>
#include <cmath>

namespace dyn::kernels {

/// The vector from the origin of `stop`, a body above `body`, to that of `body`. stop = 0: from the origin of the tree's aligned frame.
template <class T>
Vec3<T> originFrom(const PackedConstraints& c, const BasicConstraintWorkspace<T>& x, int body, int stop) {
  Vec3<T> sum;
  for (int k = c.chainOf(body), end = c.chainOf(stop); k != end; k = c.chains[static_cast<std::size_t>(k)].parent) sum += x.chains[k].arm;
  return sum;
}

/// The velocity, relative to `stop`, of the point of `body` at `arm` from its origin.
template <class T>
Motion<T> velocityFrom(const PackedConstraints& c, const BasicConstraintWorkspace<T>& x, int body, int stop, Vec3<T> arm) {
  Motion<T> sum;
  for (int k = c.chainOf(body), end = c.chainOf(stop); k != end; k = c.chains[static_cast<std::size_t>(k)].parent) {
    const Motion<T>& v = x.chains[k].velocity;
    sum.linear += v.linear + cross(v.angular, arm);
    sum.angular += v.angular;
    arm += x.chains[k].arm;
  }
  return sum;
}

/// The rotation that brings b to a, two unit vectors, the shortest way.
inline Vec3<double> tilt(const Vec3<double>& a, const Vec3<double>& b) {
  const Vec3<double> n = cross(b, a);
  const double sine = std::sqrt(dot(n, n)), cosine = dot(a, b);
  if (sine > 0) return (std::atan2(sine, cosine) / sine) * n;
  if (cosine > 0) return {};
  // Opposite vectors: any perpendicular axis will do.
  const Vec3<double> across = cross(b, std::abs(b.x) < 0.5 ? Vec3<double>{1, 0, 0} : Vec3<double>{0, 1, 0});
  return (M_PI / std::sqrt(dot(across, across))) * across;
}

/// The rotation vector of the first frame against the second, in directions that are not free, in the axes in which both rotations are given.
inline Vec3<double> turnedBy(const PackedFrameConstraint& c, const Mat3<double>& first, const Mat3<double>& second) {
  if (c.turnsFreely()) return {};
  for (int k = 0; k < 3; ++k)
    if (c.free[static_cast<std::size_t>(3 + k)]) return tilt(first.col(k), second.col(k));
  return second * log3(transpose(second) * first);
}
/// The same for states in packs, one after the other.
template <class T>
  requires(lanes_of<T> > 1)
Vec3<T> turnedBy(const PackedFrameConstraint& c, const Mat3<T>& first, const Mat3<T>& second) {
  Vec3<T> out;
  for (int l = 0; l < lanes_of<T>; ++l) {
    const Vec3<double> turned = turnedBy(c, inLane<double>(first, l), inLane<double>(second, l));
    for (int a = 0; a < 3; ++a) reinterpret_cast<double*>(&out[a])[l] = turned[a];
  }
  return out;
}

template <class P, class T>
void turnDirections(const Mat3<T>& R, const Directions& own, T (&out)[3][4]) {
  for (int k = 0; k < 3; k += rows_of<P, T>) {
    const auto read = [&](int a) {
      if constexpr (rows_of<P, T> == 1) {
        return P(own[a][k]);
      } else {
        return loadPack<P>(own[a] + k);
      }
    };
    const Vec3<P> turned = cast<P>(R) * Vec3<P>{read(0), read(1), read(2)};
    for (int a = 0; a < 3; ++a) storePack(turned[a], out[a] + k);
  }
}

template <class P, class T>
void locateFrame(const PackedConstraints& all, const BasicConstraintWorkspace<T>& x, const PackedFrameConstraint& c, RowRates rates,
                 BasicFrameRows<T>& out) {
  const bool on_world = c.body[1] == 0;
  const BasicChainState<T>&own = x.stateOf(all, c.body[0]), &other = x.stateOf(all, c.body[1]);
  out.arm[0] = own.R * cast<T>(c.placement[0].p);
  out.arm[1] = {};
  out.error = {};
  out.turn = c.common > 0 ? Mat3<T>::identity() : (on_world ? own.tree.R : transpose(other.tree.R) * own.tree.R);
  // Only targets need the arm from the world's origin.
  if (c.common > 0) {
    out.arm[1] = originFrom(all, x, c.body[0], c.common) + out.arm[0] - originFrom(all, x, c.body[1], c.common);
  } else if (!on_world || c.has_target) {
    out.arm[1] =
        transposeTimes(other.tree.R, own.tree.act(originFrom(all, x, c.body[0], 0) + out.arm[0]) - other.tree.act(originFrom(all, x, c.body[1], 0)));
  }
  out.relative = {};
  out.w[0] = out.w[1] = {};
  if (rates != RowRates::none) {
    out.w[0] = own.w;
    if (!on_world) out.w[1] = transposeTimes(out.turn, other.w);
  }
  if (rates == RowRates::velocities) {
    out.relative = velocityFrom(all, x, c.body[0], c.common, out.arm[0]);
    if (!on_world) out.relative -= turnedBack(out.turn, velocityFrom(all, x, c.body[1], c.common, out.arm[1]));
  }
  if (c.axes == ConstraintAxes::LOCAL) out.base = own.R;
  if (c.axes == ConstraintAxes::OTHER) out.base = transpose(out.turn) * other.R;
  if (c.axes == ConstraintAxes::LOCAL_WORLD_ALIGNED) out.base = transpose(own.tree.R);
  turnDirections<P>(out.base, c.linear, out.linear);
  if (c.rows > c.linear_rows) turnDirections<P>(out.base, c.angular, out.angular);
  if (!c.has_target) return;
  const Mat3<T> first = own.R * cast<T>(c.placement[0].R), second = transpose(out.turn) * (other.R * cast<T>(c.placement[1].R));
  const Vec3<T> target = other.R * cast<T>(c.placement[1].p);  // from the second body's origin
  out.error = {transposeTimes(out.turn, out.arm[1] - target), turnedBy(c, first, second)};
}

/// d/dt of the relative velocity in the constraint's axes, without the terms from the accelerations of the bodies' origins.
template <class T>
Motion<T> biasOf(const PackedFrameConstraint& c, const BasicFrameRows<T>& x) {
  const Vec3<T>&w1 = x.w[0], &w2 = x.w[1], &V = x.relative.linear;
  Motion<T> bias{cross(w1, cross(w1, x.arm[0])), {}};
  if (c.body[1] > 0) bias.linear = bias.linear - cross(w2, cross(w2, transposeTimes(x.turn, x.arm[1]))) - cross(w2, V);
  if (c.axes == ConstraintAxes::OTHER || (c.axes == ConstraintAxes::LOCAL && !c.holdsPoint())) {
    const Vec3<T>& turning = c.axes == ConstraintAxes::LOCAL ? w1 : w2;
    bias.linear -= cross(turning, V);
    bias.angular -= cross(turning, x.relative.angular);
  }
  return bias;
}

/// Calls use(row, directions, part) for every pack P of a constraint's rows, from `row` on, with their directions and the part of motions and forces,
/// linear or angular, that they act on.
template <class P, class T, class Use>
void eachPackOfRows(const PackedFrameConstraint& c, const BasicFrameRows<T>& x, Use&& use) {
  for (int k = 0; k < c.linear_rows; k += rows_of<P, T>)
    use(c.row + k, Vec3<P>{loadPack<P>(x.linear[0] + k), loadPack<P>(x.linear[1] + k), loadPack<P>(x.linear[2] + k)}, &Motion<T>::linear);
  for (int k = 0; k < c.rows - c.linear_rows; k += rows_of<P, T>)
    use(c.row + c.linear_rows + k, Vec3<P>{loadPack<P>(x.angular[0] + k), loadPack<P>(x.angular[1] + k), loadPack<P>(x.angular[2] + k)},
        &Motion<T>::angular);
}

/// Writes the rows' unit forces on body e to x.force. No other constraint uses these rows.
template <class P, class T>
void putUnitForces(const PackedConstraints& all, const PackedFrameConstraint& c, const BasicFrameRows<T>& frame, int e,
                   BasicConstraintWorkspace<T>& x) {
  if (c.body[e] == 0) return;
  const int number = all.chainOf(c.body[e]);
  const ConstrainedChain& chain = all.chains[static_cast<std::size_t>(number)];
  const std::ptrdiff_t step = ConstraintWorkspace::forceStep(chain);
  T* const forces = x.forceOf(number) - chain.row_begin;
  const Vec3<P> arm = cast<P>(frame.arm[e]);
  eachPackOfRows<P>(c, frame, [&](int row, const Vec3<P>& directions, Vec3<T> Motion<T>::*part) {
    const auto put = [&](int component, const P& value) { storePack(value, forces + component * step + row); };
    const Vec3<P> force = e == 0 ? directions : -(cast<P>(frame.turn) * directions);
    if (part == &Motion<T>::angular) {
      for (int a = 0; a < 3; ++a) put(3 + a, force[a]);
      put(ConstraintWorkspace::reach, dot(force, force));
      return;
    }
    const Vec3<P> moment = cross(arm, force);
    for (int a = 0; a < 3; ++a) {
      put(a, force[a]);
      put(3 + a, moment[a]);
    }
    put(ConstraintWorkspace::reach, dot(arm, arm) * dot(force, force));
  });
}

/// Locates frames and writes the rows' motion and their unit forces for the sweep. Chains have been located. O(constraints x chains above them).
template <class P, class T>
void placeFrames(const CompactImpl& m, const PackedConstraints& all, RowRates rates, BasicFrameRows<T>* frames, const BasicRowMotion<T>& rows,
                 BasicConstraintWorkspace<T>& x) {
  for (int k = 0; const ConstrainedChain& chain : all.chains) {
    if (chain.gathers) std::fill_n(x.forceOf(k), x.components * x.forceStep(chain) + x.widest, T(0));
    ++k;
  }
  for (std::size_t i = 0; i < all.frames.size(); ++i) {
    const PackedFrameConstraint& c = all.frames[i];
    BasicFrameRows<T>& frame = frames[i];
    locateFrame<P>(all, x, c, rates, frame);
    const Motion<T> bias = rates != RowRates::none ? biasOf(c, frame) : Motion<T>{};
    // If both bodies move, gravity cancels.
    Motion<T> fall;
    if (c.body[0] == 0 || c.body[1] == 0)
      fall.linear = T(c.body[0] > 0 ? 1.0 : -1.0) * transposeTimes(x.stateOf(all, c.body[0]).tree.R, cast<T>(m.gravity));
    const P by_velocity(c.baumgarte.velocity), by_error(c.baumgarte.position);
    eachPackOfRows<P>(c, frame, [&](int row, const Vec3<P>& directions, Vec3<T> Motion<T>::*part) {
      const P velocity = dot(directions, cast<P>(frame.relative.*part)), error = dot(directions, cast<P>(frame.error.*part)),
              rate = dot(directions, cast<P>(bias.*part));
      storePack(velocity, rows.velocity + row);
      storePack(error, rows.error + row);
      storePack(rate, rows.bias + row);
      storePack(rate + by_velocity * velocity + by_error * error, rows.drift + row);
      storePack(dot(directions, cast<P>(fall.*part)), rows.fall + row);
    });
    for (int e = 0; e < 2; ++e) putUnitForces<P>(all, c, frame, e, x);
  }
}

/// The accelerations of the rows from those of the chains, without the rows' bias. `out` has room for a pack.
template <class P, class T>
void frameAccelerations(const PackedConstraints& all, const BasicFrameRows<T>* frames, const BasicConstraintWorkspace<T>& x, T* out) {
  for (std::size_t i = 0; i < all.frames.size(); ++i) {
    const PackedFrameConstraint& c = all.frames[i];
    const BasicFrameRows<T>& frame = frames[i];
    const auto seen = [&](int e) {
      const Motion<T>& a = x.stateOf(all, c.body[e]).acceleration;
      return Motion<T>{a.linear + cross(a.angular, frame.arm[e]), a.angular};
    };
    Motion<T> relative = seen(0);
    if (c.body[1] > 0) relative -= turnedBack(frame.turn, seen(1));
    eachPackOfRows<P>(c, frame, [&](int row, const Vec3<P>& directions, Vec3<T> Motion<T>::*part) {
      storePack(dot(directions, cast<P>(relative.*part)), out + row);
    });
  }
}

/// The wrench of the rows' forces lambda, one number a row, at the constraint's origin.
inline Force<double> wrenchOf(const PackedFrameConstraint& c, const FrameRows& x, const double* lambda) {
  Force<double> out;
  const auto sum = [](const Directions& of, const double* forces, int count) {
    Vec3<double> total;
    for (int k = 0; k < count; ++k)
      for (int a = 0; a < 3; ++a) total[a] += forces[k] * of[a][k];
    return total;
  };
  out.linear = sum(x.linear, lambda + c.row, c.linear_rows);
  out.angular = sum(x.angular, lambda + c.row + c.linear_rows, c.rows - c.linear_rows);
  return out;
}

/// The same wrench as it acts on body e, at the body's origin, in the axes of its own tree.
inline Force<double> forceOnBody(const PackedFrameConstraint& c, const FrameRows& x, const double* lambda, int e) {
  Force<double> f = wrenchOf(c, x, lambda);
  if (e == 1) f = {-(x.turn * f.linear), -(x.turn * f.angular)};
  f.angular += cross(x.arm[e], f.linear);
  return f;
}

}  // namespace dyn::kernels
