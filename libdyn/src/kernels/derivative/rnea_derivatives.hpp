// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of inverse dynamics, tau = M(q) a + C(q, v) v + g(q), by q, v and a. O(n depth).
//
// Moving along degree of freedom k turns its subtree rigidly with the column S of k, and also changes the subtree's velocity and acceleration by (2)
// and (3) (Singh, Russell and Wensing 2022, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra", psi-dot and
// psi-ddot there). The terms E, A and H of a subspace that varies with q are not in that paper.
//
// All vectors are in aligned axes (aligned.hpp), at the joint's origin. Velocities are relative to that origin, so the base's linear velocity does
// not enter. With r from the parent's origin to that of body i, w its angular velocity, domega its angular acceleration, origin the classical
// acceleration of its origin (rnea.hpp), index p for the parent, S = (S_v, S_w), l the degrees of freedom of k's joint, slide = sum_l S_v,l v_l:
//
// Outward, with w, origin and domega as in aba.hpp (1), (2) and (8), from origin_0 = -gravity:
//   (1)  E = sum_l dS_l/dq_k v_l,   A = sum_l dS_l/dq_k a_l,   H = d((dS/dt) v)/dq_k        zero where the subspace does not vary
//   (2)  velocity     = (w_p x S_v - slide x S_w, w_p x S_w) + E                            change of the subtree's velocity by q
//   (3)  acceleration = (al x S_w + domega_p x S_v + w_p x velocity.linear - slide x velocity.angular, domega_p x S_w + w_p x velocity.angular)
//                       + (w x E.linear, w x E.angular) + A + H                             change of its acceleration by q
//        with al = origin_p + domega_p x r + w_p x (w_p x r) + w_p x slide
//   (4)  rate         = velocity + (w x S_v, w x S_w) + sum_l dS_k/dq_l v_l                 change of its acceleration by v
// Inward, with mass m, first moment h, inertia I about the origin. Primes are values of children, moved as in (7):
//   (5)  momentum = (w x h, I w) + sum of momentum',   K = [w]x (tr I / 2 - I) + sum of K'  K: sum of mass * velocity * position^T
//   (6)  f = (m origin + domega x h, h x origin + I domega) + (w x (w x h), w x (I w)) - fext + sum of f'
//        from now on m, h and I are those of the subtree: own + sum of m', h', I'
//   (7)  to the parent's origin, with shift_rate = w_p x r + slide:   m' = m,   h' = h + m r,   I' as in crba.hpp (1),
//        momentum' = (momentum.linear + m shift_rate, momentum.angular + h x shift_rate + r x momentum'.linear),
//        K' = K + momentum.linear r^T + shift_rate h'^T,   f' = (f.linear, f.angular + r x f.linear)
//   (8)  rigid(x) = (m x.linear + x.angular x h, h x x.linear + I x.angular)                force for an acceleration x of the subtree
//        coriolis(x) = 2 (x x momentum.linear, (tr K - K) x)                                force that a rotation rate x adds
//   (9)  by_a = rigid(S),   offset = 2 (momentum.linear x S_v + (tr K - K)^T S_w)           coriolis(x) . S = offset . x
//  (10)  by_q = rigid(acceleration) + coriolis(velocity.angular) + (S_w x f.linear, S_w x f.angular + S_v x f.linear)
//  (11)  by_v = rigid(rate) + coriolis(S_w)
// These forces of degree of freedom j then go to the root. At each joint, for each column S_k there:
//  (12)  dtau_j/dq_k = acceleration_k . by_a + velocity_k.angular . offset,   dtau_j/dv_k = rate_k . by_a + S_w,k . offset
//  (13)  dtau_k/dq_j = S_k . by_q,   dtau_k/dv_j = S_k . by_v,   M_jk = M_kj = S_k . by_a
//  (14)  to the parent's origin:  offset += 2 shift_rate x by_a.linear,   F.angular += r x F.linear for F = by_a, by_q, by_v
// Within a joint, columns and forces turn together, so (12) holds for both triangles. Last:
//  (15)  dtau_l/dq_k += dS_l/dq_k . f within a joint,   dtau_k/dv_k += damping,   M_kk += armature
#pragma once

#include "kernels/derivative/lane_group_paths.hpp"
#include "kernels/derivative/path_sweep.hpp"
#include "kernels/derivative/variations.hpp"

namespace dyn::kernels {

template <class S, class Joint>
SubspaceTerms<S> subspaceTerms(const SubspaceDerivatives<S>& dS, int nv, int slot, int m, const Mat3<S>& R, const S* v, const S* a) {
  SubspaceTerms<S> x;
  if constexpr (Joint::has_bias) {
    x.acceleration = dS.biasRate(m, slot);
    for (int l = 0; l < nv; ++l) {
      const Motion<S> along = dS.column(nv, m, l, slot);
      x.velocity += v[l] * along;
      x.acceleration += a[l] * along;
      x.rate += v[l] * dS.column(nv, l, m, slot);
    }
    for (Motion<S>* term : {&x.velocity, &x.acceleration, &x.rate}) *term = {R * term->linear, R * term->angular};
  }
  return x;
}

/// A body's axes, its joint's motion and its angular velocity, in aligned axes.
template <class S>
struct JointMotion {
  Mat3<S> R;
  Motion<S> s;
  Vec3<S> w;
};
/// Places body i, whose joint moves with v, and writes d.shift_rate. `parent` is the parent's angular velocity.
template <class S, Orthonormalisation orthonormalisation, class Joint, class Order, class... Axes>
JointMotion<S> moveAligned(const Joint& joint, const Order& order, int i, DerivativeWorkspace<S>& d, const S* v, const Vec3<S>& parent,
                           Axes&... axes) {
  Workspace<S>& w = order.w;
  const Mat3<S> R = placeAligned<S, orthonormalisation>(joint, order, order.constants(i).placement, i, w, axes...);
  const Motion<S> s = joint.timesIn(R, v);
  const Vec3<S> omega = turnedBy<Joint>(parent, s);
  Vec3<S> shift_rate = offsetRate(order, i, parent);
  if constexpr (Joint::has_linear) shift_rate += s.linear;
  d.shift_rate[i] = shift_rate;
  return {R, s, omega};
}

/// Mass, first moment, inertia and momentum (5) of body i alone. Reads its angular velocity from w.w.
template <class Joint, class S, class Order>
void writeMomentum(const Order& order, const Workspace<S>& w, int i, SubtreeMomentum<S>& own) {
  const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
  const Vec3<S>& omega = w.w[i];
  own = {mass, h, I, {cross(omega, h), I * omega}};
}
/// The terms of (6) that do not depend on the acceleration. fext: null, or external forces in the bodies' axes.
template <class T, class S>
Force<S> movingForce(const Workspace<S>& w, int i, const SubtreeMomentum<S>& own, const Force<T>* fext) {
  Force<S> f = turnedMomentum(own, w.w[i]);
  if (fext) f -= inAlignedAxes(w, i, fext[i]);
  return f;
}

/// (origin_p + domega_p x r, domega_p): the parent's acceleration at the origin of body i, without the centripetal part. For a root it is -gravity.
template <class Joint, class Order, class S>
Motion<S> carriedAcceleration(const Order& order, int i, const Motion<S>& parent, const Vec3<S>& gravity) {
  const Workspace<S>& w = order.w;
  if (order.isRoot(i)) return {isFloatingBase<Joint>(order, i) ? transposeTimes(w.rel[i].R, -gravity) : -gravity, {}};
  return {parent.linear + offsetRate(order, i, parent.angular), parent.angular};
}

/// Writes (2) to (4) for the degrees of freedom of body i's joint, whose columns have been written. `carried` is the result of
/// carriedAcceleration, `slide` the velocity at which the joint moves its origin.
template <class Joint, class Order, class S>
void writeVariations(const Order& order, DerivativeWorkspace<S>& d, int i, int iv, const Vec3<S>& wp, const Vec3<S>& omega, const Motion<S>& carried,
                     const Vec3<S>& slide, const S* v, const S* a) {
  const Workspace<S>& w = order.w;
  if constexpr (Joint::is_free)
    if (order.isRoot(i)) return floatingBaseVariations(carried.linear, slide, omega, [&](int k, const DofVariation<S>& x) { d.dof[iv + k] = x; });
  const Motion<S> parent{carried.linear + offsetAcceleration(order, i, wp), carried.angular};
  for (int k = 0; k < nvOf<Joint>(order, i); ++k) {
    const DofMotion<S> motion{w.dof[iv + k].column, wp, omega, parent, slide};
    SubspaceTerms<S> more;
    if constexpr (Joint::has_bias) {
      const BodyIndex& x = order.index(i);
      more = subspaceTerms<S, Joint>(d.subspaces[x.batch], nvOf<Joint>(order, i), x.slot, k, w.R[i], v + iv, a + iv);
    }
    writeVariation<Joint>(variationOf<Joint>(motion, more), d.dof[iv + k]);
  }
}

/// The outward part, (1) to (4): placements and motions of the bodies, and the variation of each degree of freedom.
template <class Order, class S>
void derivativesOutward(const Order& order, DerivativeWorkspace<S>& d, const Vec3<S>& gravity, const S* v, const S* a) {
  Workspace<S>& w = order.w;
  w.w[0] = {};
  const auto motion = passingAxes(order, w, w.w, w.acc);
  order.forward(motion, [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&& accelerated, auto&&... axes) {
    const Vec3<S>& wp = turning.get();
    const auto [R, s, omega] = moveAligned<S, Orthonormalisation::from_columns>(joint, order, i, d, v + iv, wp, axes...);
    writeColumns(joint, R, w.dof + iv);
    const Motion<S> carried = carriedAcceleration<Joint>(order, i, accelerated.get(), gravity), by_a = joint.timesIn(R, a + iv);
    Motion<S> acceleration = carried + velocityAcceleration(joint, order, i, R, wp, omega, s);
    if constexpr (Joint::has_linear) acceleration.linear += by_a.linear;
    if constexpr (Joint::has_angular) acceleration.angular += by_a.angular;
    writeVariations<Joint>(order, d, i, iv, wp, omega, carried, s.linear, v, a);
    accelerated.leave(acceleration);
    turning.leave(omega);
  });
}

/// The inward part, (5) to (11): composite quantities, and the forces of each degree of freedom about its joint's origin.
template <class Order, class S, class T = S>
void derivativesInward(const Order& order, DerivativeWorkspace<S>& d, const Force<T>* fext = nullptr) {
  const Workspace<S>& w = order.w;
  order.backward(passing(d.subtree), [&]<class Joint>(const Joint&, int i, int iv, auto&& subtree) {
    const Subtree<S>& all = subtree.gatherInParts([&](auto&& put) {
      Unwritten<SubtreeMomentum<S>> own;
      writeMomentum<Joint>(order, w, i, *own);
      const auto m = [&]() -> const SubtreeMomentum<S>& { return readAgain(order, *own); };
      put(&Subtree<S>::f, movingForce(w, i, m(), fext) + rigidForce(m(), w.acc[i]));
      put(&Subtree<S>::K, turnedMoment(m(), w.w[i]));
      put(&Subtree<S>::m, m());
    });
    if constexpr (Joint::is_free)
      if (order.isRoot(i)) return floatingBaseForces(d.dof + iv, all, [&](int k, const DofForces<S>& x) { d.dof_force[iv + k] = x; });
    const auto again = [&]() -> const Subtree<S>& { return readAgain(order, all); };
    for (int k = iv; k < iv + nvOf<Joint>(order, i); ++k) writeForces<Joint>(w.dof[k].column, d.dof[k], again, d.dof_force[k]);
    if (order.isRoot(i)) return;
    if (order.hasOffset(i)) {
      subtree.giveInPlace([&](Subtree<S>& at_parent) { move(again, w.r[i], d.shift_rate[i], at_parent); });
    } else {
      subtree.give(all);
    }
  });
}

/// After pathSweep: copies the entries within joints to the upper triangle.
template <class S>
void closeJoints(const CompactImpl& m, const DerivativeWorkspace<S>& d) {
  if constexpr (!in_pairs<S>) {
    d.by_q.closeJoints(m);
    d.by_v.closeJoints(m);
  }
}
/// After closeJoints: adds x to the entry of by_q of two degrees of freedom of one joint.
template <class S>
void addOwn(const CompactImpl& m, const DerivativeWorkspace<S>& d, int row, int column, const S& x) {
  if constexpr (in_pairs<S>) {
    d.pairs.at(m, PathPairs<S>::q_lower, row, column) += x;
  } else {
    d.by_q.addOwn(row, column, x);
  }
}
/// Diagonal entry k of by_a (matrix 0) or by_v (matrix 1).
template <class S>
S& diagonal(const CompactImpl& m, const DerivativeWorkspace<S>& d, int matrix, int k) {
  if constexpr (in_pairs<S>) {
    return d.pairs.at(m, matrix == 0 ? PathPairs<S>::by_a : PathPairs<S>::v_lower, k, k);
  } else {
    return (matrix == 0 ? d.by_a : d.by_v).below[k][k];
  }
}

/// dS_k/dq_m . f, the first term of (15): k and m count within the joint of body i.
template <class Joint, class Order, class S>
S subspaceTorque(const Order& order, const DerivativeWorkspace<S>& d, const Force<S>& f, int i, int m, int k) {
  const BodyIndex& x = order.index(i);
  const Mat3<S>& R = order.w.R[i];
  const Motion<S> dS = d.subspaces[x.batch].column(nvOf<Joint>(order, i), m, k, x.slot);
  return dot(Motion<S>{R * dS.linear, R * dS.angular}, f);
}

/// Calls add(matrix, k, x) for each diagonal term: armature for by_a (matrix 0), damping for by_v (matrix 1).
template <class Add>
void addDissipationDerivatives(const CompactImpl& m, Add&& add) {
  for (std::size_t k = 0; k < m.armature.size(); ++k) add(0, static_cast<int>(k), m.armature[k]);
  for (std::size_t k = 0; k < m.damping.size(); ++k) add(1, static_cast<int>(k), m.damping[k]);
}

/// After derivativesInward, (12) to (15): the derivatives of rnea, dissipation included, in d.by_q, d.by_v and d.by_a, or in d.pairs.
template <class Wide, class R, class S>
void derivativesSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  pathSweep<Wide>(recursion, d);
  const CompactImpl& m = recursion.order.m;
  closeJoints(m, d);
  recursion.order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    if constexpr (Joint::has_bias)
      for (int along = 0, nv = nvOf<Joint>(recursion.order, i); along < nv; ++along)
        for (int k = 0; k < nv; ++k)
          addOwn(m, d, iv + k, iv + along, numberOf(subspaceTorque<Joint>(recursion.order, recursion.d, recursion.d.subtree[i].f, i, along, k)));
  });
  addDissipationDerivatives(m, [&](int matrix, int k, double x) { diagonal(m, d, matrix, k) += S(static_cast<Real<S>>(x)); });
}

/// The derivatives of rnea, dissipation included, into d.by_q, d.by_v and d.by_a, or d.pairs. w has the evaluated joints, d the derivatives of their
/// subspaces.
template <class Wide, class S>
void rneaDerivatives(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* a, const Force<S>* fext = nullptr) {
  const auto r = recursion(m, w, d);
  derivativesOutward(r.order, r.d, r.order.gravity(), r.velocities(v), r.accelerations(a));
  derivativesInward(r.order, r.d, fext);
  derivativesSweep<Wide>(r, d);
}
/// The same for one state, into the output matrices. Quad: the pack whose lanes hold the joints of a lane group.
template <class Wide, class Quad>
void rneaDerivativesInPlace(const CompactImpl& m, Workspace<double>& w, DerivativeWorkspace<double>& d, const double* v, const double* a,
                            const Force<double>* fext, const PathDerivatives& out) {
  withRecursion<Quad>(m, w, d, m.lane_groups.uses.derivatives, [&](const auto& r) {
    derivativesOutward(r.order, r.d, r.order.gravity(), r.velocities(v), r.accelerations(a));
    derivativesInward(r.order, r.d, r.external(fext));
    if constexpr (std::remove_cvref_t<decltype(r)>::over_lane_groups) {
      laneGroupPathSweep(r, out);
      addDissipationDerivatives(m, [&](int matrix, int k, double x) {
        if (double* to = matrix == 0 ? out.by_a : out.by_v) to[(m.nvx + 1) * k] += x;
      });
    } else {
      derivativesSweep<Wide>(r, d);
      const auto assemble = [&](const PathMatrix<double>& from, double* to) { from.assemble<Wide>(m.dof_end, Rows<double>{to, m.nvx}); };
      assemble(d.by_q, out.by_q);
      assemble(d.by_v, out.by_v);
      if (out.by_a) assemble(d.by_a, out.by_a);
    }
  });
}

}  // namespace dyn::kernels
