// SPDX-License-Identifier: BSD-2-Clause
// The terms of each body and of each degree of freedom in the derivatives of the dynamics; numbers (n) are equations of rnea_derivatives.hpp.
#pragma once

#include "kernels/derivative/recursion.hpp"
#include "kernels/recursion/crba.hpp"

namespace dyn::kernels {

/// a b^T.
template <class S>
Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
  Mat3<S> out;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) out(i, j) = a[i] * b[j];
  return out;
}

/// M [r]x.
template <class S>
Mat3<S> timesSkew(const Mat3<S>& M, const Vec3<S>& r) {
  Mat3<S> out;
  for (int i = 0; i < 3; ++i) {
    const Vec3<S> row = cross(M.row(i), r);
    for (int j = 0; j < 3; ++j) out(i, j) = row[j];
  }
  return out;
}
/// [w]x M.
template <class S>
Mat3<S> crossColumns(const Vec3<S>& w, const Mat3<S>& M) {
  Mat3<S> out;
  for (int j = 0; j < 3; ++j) {
    const Vec3<S> column = cross(w, M.col(j));
    for (int i = 0; i < 3; ++i) out(i, j) = column[i];
  }
  return out;
}

/// The matrix tr K - K: it maps a rotation rate x to sum m r x (x x r'), where K = sum m r' r^T and r' is the velocity of the mass m at r.
template <class S>
Mat3<S> turningTorque(const Mat3<S>& K) {
  return {{K(1, 1) + K(2, 2), -K(0, 1), -K(0, 2),  //
           -K(1, 0), K(2, 2) + K(0, 0), -K(1, 2),  //
           -K(2, 0), -K(2, 1), K(0, 0) + K(1, 1)}};
}
inline Mat3<Vectored> turningTorque(const Mat3<Vectored>& K) { return trace(K) * Mat3<Vectored>::identity() - K; }

/// (8): the Coriolis force [N, N m] about the joint's origin that a rotation rate x adds in a subtree. `torque` is turningTorque of the subtree's K.
template <class S>
Force<S> coriolis(const SubtreeMomentum<S>& m, const Mat3<S>& torque, const Vec3<S>& x) {
  return S(2) * Force<S>{cross(x, m.momentum.linear), torque * x};
}
/// The projection of Coriolis forces on a motion s, as a vector: coriolis(x) . s = offset . x.
template <class Joint, class S>
Vec3<S> coriolisOffset(const SubtreeMomentum<S>& m, const Mat3<S>& torque, const Motion<S>& s) {
  Vec3<S> offset{};
  if constexpr (Joint::has_angular) offset = transposeTimes(torque, s.angular);
  if constexpr (Joint::has_linear) offset += cross(m.momentum.linear, s.linear);
  return S(2) * offset;
}

/// (8): the force that accelerates a subtree by x.
template <class S>
Force<S> rigidForce(const SubtreeMomentum<S>& m, const Motion<S>& x) {
  return {m.mass * x.linear + cross(x.angular, m.h), cross(m.h, x.linear) + m.I * x.angular};
}
/// The same for motions that have the same parts as the joint's columns.
template <class Joint, class S>
Force<S> rigidForceOf(const SubtreeMomentum<S>& m, const Motion<S>& x) {
  if constexpr (!Joint::has_linear) {
    return {cross(x.angular, m.h), m.I * x.angular};
  } else {
    return rigidForce(m, x);
  }
}

/// s x* f: how a force that is fixed to a body changes when the body turns with s (Featherstone 2008, eq. 2.32).
template <class S>
Force<S> turned(const Motion<S>& s, const Force<S>& f) {
  return {cross(s.angular, f.linear), cross(s.angular, f.angular) + cross(s.linear, f.linear)};
}
template <class Joint, class S>
Force<S> turnedOf(const Motion<S>& s, const Force<S>& f) {
  if constexpr (!Joint::has_linear) {
    return {cross(s.angular, f.linear), cross(s.angular, f.angular)};
  } else {
    return turned(s, f);
  }
}

/// The force on a body that turns with w, apart from the force for its acceleration.
template <class S>
Force<S> turnedMomentum(const SubtreeMomentum<S>& m, const Vec3<S>& w) {
  return {cross(w, m.momentum.linear), cross(w, m.momentum.angular)};
}
/// K of a body that turns with w: the sum of mass * velocity * position^T.
template <class S>
Mat3<S> turnedMoment(const SubtreeMomentum<S>& m, const Vec3<S>& w) {
  // The sum of mass * position * position^T, whose columns turn with the body. It must be symmetric to the last bit: only then is the trace of a
  // rigid body's K zero.
  const Mat3<S> second = (S(0.5) * trace(m.I)) * Mat3<S>::identity() - symmetricMatrix(m.I);
  return crossColumns(w, second);
}

/// (7): subtree x() about the parent's origin, with velocities relative to that origin. r: from the parent's origin to the joint's, whose velocity is
/// rate. x() is called for each part that is written, so that it may read the subtree again instead of keeping it in registers.
template <class S, class Again>
void move(const Again& x, const Vec3<S>& r, const Vec3<S>& rate, Subtree<S>& out) {
  {
    const Subtree<S>& from = x();
    out.f = {from.f.linear, from.f.angular + cross(r, from.f.linear)};
  }
  {
    const SubtreeMomentum<S>& m = x().m;
    out.m.mass = m.mass;
    out.m.I = shiftedInertia(m.I, m.mass, m.h, r);
  }
  {
    const SubtreeMomentum<S>& m = x().m;
    const Vec3<S> linear = m.momentum.linear + m.mass * rate;
    out.m.momentum = {linear, m.momentum.angular + cross(m.h, rate) + cross(r, linear)};
  }
  const Subtree<S>& from = x();
  out.m.h = from.m.h + from.m.mass * r;
  out.K = from.K + outer(from.m.momentum.linear, r) + outer(rate, out.m.h);
}

/// (2) to (4), after Singh, Russell and Wensing 2022. `more`: E, A + H and the last term of (4).
template <class Joint, class S>
DofVariation<S> variationOf(const DofMotion<S>& x, const SubspaceTerms<S>& more) {
  const Vec3<S>&sl = x.column.linear, &sw = x.column.angular, &wp = x.w_parent;
  Vec3<S> al = x.acceleration.linear;
  if constexpr (Joint::has_linear) al += cross(wp, x.slide);
  Motion<S> velocity{{}, cross(wp, sw)}, acceleration{cross(al, sw), cross(x.acceleration.angular, sw)}, rate = velocity;
  // A joint that turns about one axis does not change that axis.
  if constexpr (!Joint::about_z) rate.angular = cross(x.w, sw);
  if constexpr (Joint::has_linear) {
    velocity.linear = cross(wp, sl) - cross(x.slide, sw);
    acceleration.linear += cross(x.acceleration.angular, sl);
    rate.linear = cross(x.w, sl);
  }
  if constexpr (Joint::has_bias) {
    velocity += more.velocity;
    rate += more.rate;
    acceleration += more.acceleration + Motion<S>{cross(x.w, more.velocity.linear), cross(x.w, more.velocity.angular)};
  }
  if constexpr (Joint::has_linear) acceleration.linear += cross(wp, velocity.linear) - cross(x.slide, velocity.angular);
  acceleration.angular += cross(wp, velocity.angular);
  return {velocity, acceleration, velocity + rate};
}

/// The same for a floating base, whose columns are the axes and whose parent, the world, is at rest. `acceleration` is the world's less gravity,
/// `slide` and `omega` are the base's linear and angular velocity.
template <class S, class Use>
void floatingBaseVariations(const Vec3<S>& acceleration, const Vec3<S>& slide, const Vec3<S>& omega, Use&& use) {
  const Mat3<S> accelerates = skew(acceleration), slides = skew(slide), turns = skew(omega);
  for (int k = 0; k < 3; ++k) {
    const Vec3<S> back = -slides.col(k);
    use(k, DofVariation<S>{{}, {}, {turns.col(k), {}}});
    use(3 + k, DofVariation<S>{{back, {}}, {accelerates.col(k), {}}, {back, turns.col(k)}});
  }
}

/// Writes those parts of a variation that can be non-zero for the joint's shape. The other parts keep the zeros of the memory, as in writeColumns.
template <class Joint, class S>
void writeVariation(const DofVariation<S>& x, DofVariation<S>& to) {
  if constexpr (Joint::has_linear) {
    to.velocity.linear = x.velocity.linear;
    to.rate.linear = x.rate.linear;
  }
  to.acceleration.linear = x.acceleration.linear;
  if constexpr (Joint::has_angular) {
    to.velocity.angular = x.velocity.angular;
    to.acceleration.angular = x.acceleration.angular;
    to.rate.angular = x.rate.angular;
  }
}

/// (9) to (11): the forces of a degree of freedom with column s and variation x. c() returns the subtree and is called as in move().
template <class Joint, class S, class Again>
void writeForces(const Motion<S>& s, const DofVariation<S>& x, const Again& c, DofForces<S>& out) {
  out.by_a = rigidForceOf<Joint>(c().m, s);
  {
    const Subtree<S>& all = c();
    const Mat3<S> torque = turningTorque(all.K);
    out.offset = coriolisOffset<Joint>(all.m, torque, s);
    out.by_v = rigidForceOf<Joint>(all.m, x.rate) + coriolis(all.m, torque, s.angular);
  }
  const Subtree<S>& all = c();
  out.by_q = rigidForce(all.m, x.acceleration) + coriolis(all.m, turningTorque(all.K), x.velocity.angular) + turnedOf<Joint>(s, all.f);
}

/// The same for all six degrees of freedom of a floating base, whose variations begin at x.
template <class S, class Use>
void floatingBaseForces(const DofVariation<S>* x, const Subtree<S>& c, Use&& use) {
  const SubtreeMomentum<S>& m = c.m;
  const S two(2);
  const Mat3<S> second = turningTorque(c.K), offset = transpose(second), inertia = m.I.matrix();
  const Mat3<S> h = skew(m.h), momentum = skew(m.momentum.linear), linear = skew(c.f.linear), angular = skew(c.f.angular);
  const Mat3<S> mass = m.mass * Mat3<S>::identity();
  for (int k = 0; k < 3; ++k) {
    const Vec3<S> slid = x[k].rate.linear, accelerated = x[3 + k].acceleration.linear, turned_force = linear.col(k);
    use(k, DofForces<S>{{mass.col(k), h.col(k)}, two * momentum.col(k), {{}, -turned_force}, {m.mass * slid, cross(m.h, slid)}});
    const Force<S> by_v = rigidForce(m, x[3 + k].rate);
    use(3 + k, DofForces<S>{{-h.col(k), inertia.col(k)},
                            two * offset.col(k),
                            {m.mass * accelerated - turned_force, cross(m.h, accelerated) - angular.col(k)},
                            {by_v.linear - two * momentum.col(k), by_v.angular + two * second.col(k)}});
  }
}

}  // namespace dyn::kernels
