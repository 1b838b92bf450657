// Derivatives of inverse dynamics, in aligned frames.
//
// Moving along degree of freedom m turns its subtree rigidly with s_m and adds to the subtree's velocity and acceleration (Singh, Russell
// and Wensing 2022, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra", psi-dot and psi-ddot there)
//   dv = v_p x s + E,   da = a_p x s + v_p x dv + v x E + A + H
// where p is the parent, and E, A, H, the terms of a subspace that varies with q, are not in that paper:
//   E = sum_l dS_l/dq_m v_l,   A = sum_l dS_l/dq_m a_l,   H = d((dS/dt) v)/dq_m.
// The Coriolis force that a turning rate w brings to the bodies of a subtree is 2 sum m [w x r'; r x (w x r')], r' their velocities: of
// these it takes the momentum and K = sum m r' r^T. Velocities are counted relative to each joint's origin, so the base's does not enter.
#pragma once

#include "kernels/path_sweep.hpp"
#include "kernels/strip_paths.hpp"
#include "kernels/variations.hpp"

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
/// Places body i, whose joint moves with v.
template <class S, Renewal renewal, class Joint, class Order, class... Axes>
JointMotion<S> moveAligned(const Joint& joint, const Order& order, int i, DerivativeWorkspace<S>& d, const S* v, const Vec3<S>& parent,
                           Axes&... axes) {
  Workspace<S>& w = order.w;
  const Mat3<S> R = placeAligned<S, renewal>(joint, order, order.constants(i).placement, i, w, axes...);
  const Motion<S> s = joint.timesIn(R, v);
  const Vec3<S> omega = turnedBy<Joint>(parent, s);
  Vec3<S> shift_rate = leverRate(order, i, parent);
  if constexpr (Joint::has_linear) shift_rate += s.linear;
  d.shift_rate[i] = shift_rate;
  return {R, s, omega};
}

/// Of body i alone, which turns with w.w.
template <class Joint, class S, class Order>
void writeMomentum(const Order& order, const Workspace<S>& w, int i, SubtreeMomentum<S>& own) {
  const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
  const Vec3<S>& omega = w.w[i];
  own = {mass, h, I, {cross(omega, h), I * omega}};
}
/// What moves it but for its acceleration. fext: null, or external forces in the bodies' axes.
template <class T, class S>
Force<S> movingForce(const Workspace<S>& w, int i, const SubtreeMomentum<S>& own, const Force<T>* fext) {
  Force<S> f = turnedMomentum(own, w.w[i]);
  if (fext) f -= inAlignedAxes(w, i, fext[i]);
  return f;
}

/// The parent's acceleration carried to where body i's joint is, but for what the parent's own turning adds; of a root as if gravity were an
/// acceleration of the world.
template <class Joint, class Order, class S>
Motion<S> carriedAcceleration(const Order& order, int i, const Motion<S>& parent, const Vec3<S>& gravity) {
  const Workspace<S>& w = order.w;
  if (order.isRoot(i)) return {isFlyingRoot<Joint>(order, i) ? transposeTimes(w.rel[i].R, -gravity) : -gravity, {}};
  return {parent.linear + leverRate(order, i, parent.angular), parent.angular};
}

/// Variations of the degrees of freedom of body i's joint, whose columns are there: `carried` is what carriedAcceleration gave, `slide` the
/// velocity at which the joint carries its origin.
template <class Joint, class Order, class S>
void writeVariations(const Order& order, DerivativeWorkspace<S>& d, int i, int iv, const Vec3<S>& wp, const Vec3<S>& omega, const Motion<S>& carried,
                     const Vec3<S>& slide, const S* v, const S* a) {
  const Workspace<S>& w = order.w;
  if constexpr (Joint::is_free)
    if (order.isRoot(i)) return flyingVariations(carried.linear, slide, omega, [&](int k, const DofVariation<S>& x) { d.dof[iv + k] = x; });
  const Motion<S> parent{carried.linear + leverAcceleration(order, i, wp), carried.angular};
  for (int k = 0; k < nvOf<Joint>(order, i); ++k) {
    const DofMotion<S> motion{w.dof[iv + k].S_, wp, omega, parent, slide};
    SubspaceTerms<S> more;
    if constexpr (Joint::has_bias) {
      const BodyIndex& x = order.index(i);
      more = subspaceTerms<S, Joint>(d.subspaces[x.batch], nvOf<Joint>(order, i), x.slot, k, w.R[i], v + iv, a + iv);
    }
    writeVariation<Joint>(variationOf<Joint>(motion, more), d.dof[iv + k]);
  }
}

/// Placements and motions of the bodies, and each degree of freedom's variation.
template <class Order, class S>
void derivativesOutward(const Order& order, DerivativeWorkspace<S>& d, const Vec3<S>& gravity, const S* v, const S* a) {
  Workspace<S>& w = order.w;
  w.w[0] = {};
  const auto motion = passingAxes(order, w, w.w, w.acc);
  order.forward(motion, [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&& accelerated, auto&&... axes) {
    const Vec3<S>& wp = turning.get();
    const auto [R, s, omega] = moveAligned<S, Renewal::from_columns>(joint, order, i, d, v + iv, wp, axes...);
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

/// Composite quantities, and from them the forces that each degree of freedom's variations bring, about its joint's origin.
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
      if (order.isRoot(i)) return flyingForces(d.dof + iv, all, [&](int k, const DofForces<S>& x) { d.dof_force[iv + k] = x; });
    const auto again = [&]() -> const Subtree<S>& { return readAgain(order, all); };
    for (int k = iv; k < iv + nvOf<Joint>(order, i); ++k) writeForces<Joint>(w.dof[k].S_, d.dof[k], again, d.dof_force[k]);
    if (order.isRoot(i)) return;
    if (order.hasLever(i)) {
      subtree.giveInPlace([&](Subtree<S>& at_parent) { move(again, w.r[i], d.shift_rate[i], at_parent); });
    } else {
      subtree.give(all);
    }
  });
}

/// After pathSweep: the entries within joints on both sides.
template <class S>
void closeJoints(const CompactImpl& m, const DerivativeWorkspace<S>& d) {
  if constexpr (!in_pairs<S>) {
    d.by_q.closeJoints(m);
    d.by_v.closeJoints(m);
  }
}
/// After that: to the entry of by_q of two of one joint's.
template <class S>
void addOwn(const CompactImpl& m, const DerivativeWorkspace<S>& d, int row, int column, const S& x) {
  if constexpr (in_pairs<S>) {
    d.pairs.at(m, PathPairs<S>::q_below, row, column) += x;
  } else {
    d.by_q.addOwn(row, column, x);
  }
}
/// Of the diagonal of by_a, or by_v.
template <class S>
S& diagonal(const CompactImpl& m, const DerivativeWorkspace<S>& d, int matrix, int k) {
  if constexpr (in_pairs<S>) {
    return d.pairs.at(m, matrix == 0 ? PathPairs<S>::by_a : PathPairs<S>::v_below, k, k);
  } else {
    return (matrix == 0 ? d.by_a : d.by_v).below[k][k];
  }
}

/// What the torque s . f of a subspace that varies changes along degree of freedom m: s_k's part of it.
template <class Joint, class Order, class S>
S subspaceTorque(const Order& order, const DerivativeWorkspace<S>& d, const Force<S>& f, int i, int m, int k) {
  const BodyIndex& x = order.index(i);
  const Mat3<S>& R = order.w.R[i];
  const Motion<S> dS = d.subspaces[x.batch].column(nvOf<Joint>(order, i), m, k, x.slot);
  return dot(Motion<S>{R * dS.linear, R * dS.angular}, f);
}

/// Armature and damping, which are on the diagonals: add(matrix, k, x) is called for each, by_a 0 and by_v 1.
template <class Add>
void addLossDerivatives(const CompactImpl& m, Add&& add) {
  for (std::size_t k = 0; k < m.armature.size(); ++k) add(0, static_cast<int>(k), m.armature[k]);
  for (std::size_t k = 0; k < m.damping.size(); ++k) add(1, static_cast<int>(k), m.damping[k]);
}

/// After derivativesInward: d.by_q, d.by_v and d.by_a, or d.pairs, which are the derivatives of rnea, losses included.
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
  addLossDerivatives(m, [&](int matrix, int k, double x) { diagonal(m, d, matrix, k) += S(static_cast<Real<S>>(x)); });
}

/// The derivatives of rnea, losses included, into d.by_q, d.by_v and d.by_a, or d.pairs. Joints have been asked into w, how subspaces vary into d.
template <class Wide, class S>
void rneaDerivatives(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* a, const Force<S>* fext = nullptr) {
  const auto r = recursion(m, w, d);
  derivativesOutward(r.order, r.d, r.order.gravity(), r.velocities(v), r.accelerations(a));
  derivativesInward(r.order, r.d, fext);
  derivativesSweep<Wide>(r, d);
}
/// The same of one state, into place. Quad: in whose lanes strips may be.
template <class Wide, class Quad>
void rneaDerivativesInPlace(const CompactImpl& m, Workspace<double>& w, DerivativeWorkspace<double>& d, const double* v, const double* a,
                            const Force<double>* fext, const PathDerivatives& out) {
  withRecursion<Quad>(m, w, d, m.strips.uses.derivatives, [&](const auto& r) {
    derivativesOutward(r.order, r.d, r.order.gravity(), r.velocities(v), r.accelerations(a));
    derivativesInward(r.order, r.d, r.external(fext));
    if constexpr (std::remove_cvref_t<decltype(r)>::over_strips) {
      stripPathSweep(r, out);
      addLossDerivatives(m, [&](int matrix, int k, double x) {
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
