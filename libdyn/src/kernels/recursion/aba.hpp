// SPDX-License-Identifier: BSD-2-Clause
// The articulated-body algorithm (Featherstone 2008, ch. 7): a = M(q)^-1 (tau - C(q, v) v - g(q)). O(n).
//
// Accelerations are the classical ones of the joints' origins (rnea.hpp). All vectors are in aligned axes (aligned.hpp), at the joint's origin. r is
// the joint offset of body i, R rotates from its axes to aligned axes, (S_v, S_w) are its joint's columns, b is the joint's bias, p is the parent.
//
// Outward:
//   (1)  w    = w_p + S_w v
//   (2)  beta = (w_p x (w_p x r) + (w_p + w) x (S_v v), w_p x (S_w v)) + R b          acceleration due to velocities
// Inward, with mass m, first moment h, inertia I about the origin:
//   (3)  IA   = rigid(m, h, I) + sum over children of IA'                             articulated inertia
//   (4)  pA   = (w x (w x h), w x (I w)) - fext + sum over children of pA'            bias force
//   for each degree of freedom k of the joint in turn, with its column S:
//   (5)  W = IA S,   D = S^T W + armature,   y = (tau_k - S^T pA) / D
//   (6)  IA -= W W^T / D,   pA += y W
//   (7)  IA', pA' = IA, pA + IA beta, moved by r to the parent's origin               handed to the parent
// Outward again, from a_0 = -gravity; the last degree of freedom of a joint first:
//   (8)  a  = a_p + (domega_p x r, 0) + beta
//   (9)  ddq_k = y - W^T a / D,   a += S ddq_k
// The last degree of freedom of a joint is solved for from the parent's acceleration: for it, W / D at the parent's origin and y - W^T beta / D are
// stored. A root hands nothing on, so (6) is left out for its last degree of freedom, and (7) wholly.
#pragma once

#include "kernels/body/axes_elimination.hpp"
#include "kernels/recursion/aligned.hpp"

namespace dyn::kernels {

/// Computes poses, velocities and accelerations due to velocities, equations (1) and (2).
template <class S, BodyOrder Order>
void abaOutward(const Order& order, Workspace<S>& w, const S* v) {
  w.w[0] = {};
  order.forward(passingAxes(order, w, w.w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&&... axes) {
    const Mat3<S> R = placeAligned<S>(joint, order, order.constants(i).placement, i, w, axes...);
    const Vec3<S>& wp = turning.get();
    const Motion<S> s = joint.timesIn(R, v + iv);

    const Vec3<S> omega = turnedBy<Joint>(wp, s);
    w.beta[i] = velocityAcceleration(joint, order, i, R, wp, omega, s);
    turning.leave(omega);
    writeColumns(joint, R, w.dof + iv);
  });
}

/// Notes `body` in `failed` if the pivot of one of its columns vanished.
template <class S, class Column>
void noteVanishing(const S& pivot, const Column& column, const ArticulatedInertia<S>& I, int body, int* failed) {
  noteVanishing(pivot, column.weighted(trace(I.linear), trace(I.angular)), body, failed);
}

/// Computes the factor of degree of freedom k of the model, which belongs to body i, equation (5).
template <class S, class Order, class Column>
void eliminate(const Order& order, const ArticulatedInertia<S>& IA, const Force<S>& pA, const Column& column, const S* tau, int k, int i,
               Workspace<S>& w) {
  DofFactor<S>& dof = w.dof[k];
  dof.W = column.force(IA);
  const S pivot = column.along(dof.W) + order.armature(k);
  noteVanishing(pivot, column, IA, i, w.failed);
  dof.inverse = S(1) / pivot;
  dof.y = (tau[k] - column.along(pA)) / pivot;
}

/// Whether body i is a plain floating base: elimination leaves no inertia in its directions. Armature would leave some, because it resists
/// acceleration but has no weight.
template <class Joint, class Order>
bool isPlainFloatingBase(const Order& order, int i) {
  return isFloatingBase<Joint>(order, i) && !order.m.roots_have_armature;
}

/// Moves an articulated inertia and its bias force to a new point. r leads from the new point to the old one.
template <class S>
void shift(ArticulatedInertia<S>& IA, Force<S>& f, const Vec3<S>& r) {
  IA = IA.shifted(r);
  addCross(f.angular, r, f.linear);
}

/// abaInward() at a plain floating base.
template <class S, class Order>
void eliminatePlainFloatingBase(const Order& order, const ArticulatedInertia<S>& IA, const Force<S>& pA, const S* tau, int i, int iv,
                                Workspace<S>& w) {
  const AxesElimination<false, S> axes(order, IA, i, iv, w.failed);
  S y[6];
  eachAxis([&](int k) { y[k] = tau[k] - UnitColumn<S>{k}.along(pA); });
  axes.solve(y);
  eachAxis([&](int k) {
    w.dof[iv + k].y = y[k];
    w.dof[iv + k].W = axes.column(k);
    w.dof[iv + k].inverse = axes.inverse(k);
  });
}

/// Makes body i's last degree of freedom one that is solved for first, from the parent's acceleration.
template <class S>
void solveFromParent(const Workspace<S>& w, int i, DofFactor<S>& dof) {
  dof.y -= dof.inverse * dot(w.beta[i], dof.W);
  dof.W = dof.inverse * Force<S>{dof.W.linear, dof.W.angular + cross(w.r[i], dof.W.linear)};
}

/// Eliminates each degree of freedom (pivot S^T IA S + armature), projects inertia and bias force, and hands them to the parent, equations (3) to
/// (7). w.failed tells the first body whose pivot vanished, or 0.
template <class S, BodyOrder Order>
void abaInward(const Order& order, Workspace<S>& w, const S* tau, const Force<S>* fext = nullptr) {
  for (int& body : w.failed) body = 0;
  order.backward(passing(w.IA, w.pA), [&]<class Joint>(const Joint&, int i, int iv, auto&& inertia, auto&& force) {
    const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
    const Vec3<S>& omega = w.w[i];
    Force<S> own{cross(omega, cross(omega, h)), cross(omega, I * omega)};
    if (fext) own -= inAlignedAxes(w, i, fext[i]);
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(mass, h, I));
    Force<S> pA = force.with(own);
    // Eliminating one direction after the other is the factorisation: each step updates IA, and the next pivot is read from it. This happens at the
    // joint's origin, before the shift. The projection cancels digits, and its small remainder must not be lost under larger numbers.
    const int last = nvOf<Joint>(order, i) - 1;
    if (isPlainFloatingBase<Joint>(order, i)) {
      if constexpr (Joint::is_free) eliminatePlainFloatingBase(order, IA, pA, tau + iv, i, iv, w);
    } else {
      withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
        for (int k = 0; k <= last; ++k) {
          eliminate(order, IA, pA, column(k), tau, iv + k, i, w);
          if (k == last && order.isRoot(i)) break;
          const DofFactor<S>& dof = w.dof[iv + k];
          IA.subtractSquare(dof.W, dof.inverse);
          pA += dof.y * dof.W;
        }
      });
    }
    solveFromParent(w, i, w.dof[iv + last]);
    if (order.isRoot(i)) return;
    pA += IA * w.beta[i];
    if (order.hasOffset(i)) shift(IA, pA, w.r[i]);
    inertia.give(IA);
    force.give(pA);
  });
}

/// Computes accelerations under this gravity, equations (8) and (9), parents first. Within a joint it goes in the reverse order of elimination.
template <class S, BodyOrder Order>
void abaSolve(const Order& order, Workspace<S>& w, const Vec3<S>& gravity, S* ddq) {
  w.acc[0] = {};
  order.forward(passing(w.acc), [&]<class Joint>(const Joint&, int i, int iv, auto&& acceleration) {
    Motion<S> parent = acceleration.get();
    if (order.isRoot(i)) parent.linear = isFloatingBase<Joint>(order, i) ? transposeTimes(w.rel[i].R, -gravity) : -gravity;
    const int last = nvOf<Joint>(order, i) - 1;
    const S x = w.dof[iv + last].y - dot(parent, w.dof[iv + last].W);
    Motion<S> a = parent + w.beta[i];
    if (!order.isRoot(i)) a.linear += offsetRate(order, i, parent.angular);
    withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
      ddq[iv + last] = x;
      column(last).addTo(a, x);
      for (int k = last - 1; k >= 0; --k) {
        const DofFactor<S>& f = w.dof[iv + k];
        ddq[iv + k] = f.y - dot(a, f.W) * f.inverse;
        column(k).addTo(a, ddq[iv + k]);
      }
    });
    acceleration.leave(a);
  });
}

}  // namespace dyn::kernels
