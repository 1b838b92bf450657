// The articulated-body algorithm in aligned frames (Featherstone 2008, ch. 7), with classical accelerations.
#pragma once

#include "kernels/aligned.hpp"

#include <limits>

namespace dyn::kernels {

/// Poses, velocity-dependent accelerations, rigid inertias and bias forces.
template <class S, class Order>
void abaOutward(const Order& order, Workspace<S>& w, const S* v, const Force<S>* fext) {
  w.w[0] = {};
  order.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const auto& c = order.constants(i);
    placeAligned<S>(joint, order, c.placement, i, w);
    const Mat3<S>& R = w.R[i];
    const Vec3<S>& wp = order.parent(w.w, i);
    const Motion<S> s = joint.times(v + iv);

    Vec3<S> omega = wp;
    Motion<S> beta{cross(wp, cross(wp, w.r[i])), {}};
    if constexpr (Joint::has_angular) {
      const Vec3<S> turning = R * s.angular;
      omega += turning;
      beta.angular += cross(wp, turning);
    }
    if constexpr (Joint::has_linear) beta.linear += cross(wp + omega, R * s.linear);
    if constexpr (Joint::has_bias) {
      const Motion<S> b = joint.bias();
      beta += {R * b.linear, R * b.angular};
    }
    w.w[i] = omega;
    w.beta[i] = beta;

    const Vec3<S> h = R * c.h;
    const Sym3<S> I = congruence(R, c.origin);
    w.IA[i] = ArticulatedInertia<S>::rigid(c.mass, h, I);
    w.pA[i] = {cross(omega, cross(omega, h)), cross(omega, I * omega)};
    if (fext) w.pA[i] -= Force<S>{R * fext[i].linear, R * fext[i].angular};
    for (int k = 0; k < Joint::nv; ++k) w.dof[iv + k].S_ = alignedColumn(joint, k, R);
  });
}

/// A pivot that is not above the rounding of what was subtracted to get it is zero. The yardstick is the inertia left in other
/// directions at the same body, so it scales with the model's units. Notes the body, lane by lane.
template <class S>
void noteVanishing(const S& pivot, const Motion<S>& column, const ArticulatedInertia<S>& I, int body, int* failed) {
  using T = Real<S>;
  const S linear = I.linear.xx + I.linear.yy + I.linear.zz, angular = I.angular.xx + I.angular.yy + I.angular.zz;
  const S yardstick = dot(column.linear, column.linear) * linear + dot(column.angular, column.angular) * angular;
  const S least = S(4 * std::numeric_limits<T>::epsilon()) * yardstick;
  if (allOf(both(pivot > least, pivot <= S(std::numeric_limits<T>::max())))) return;
  const T *p = reinterpret_cast<const T*>(&pivot), *l = reinterpret_cast<const T*>(&least);
  for (int i = 0; i < lanes_of<S>; ++i)
    if (!(p[i] > l[i] && p[i] <= std::numeric_limits<T>::max()) && failed[i] == 0) failed[i] = body;
}

/// Eliminates each degree of freedom (pivot S^T IA S + armature), projects inertia and bias force, hands them to the parent.
/// w.failed tells lane by lane whether a pivot vanished.
template <class S, class Order>
void abaInward(const Order& order, Workspace<S>& w, const S* tau) {
  for (int& body : w.failed) body = 0;
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    constexpr int nv = Joint::nv;
    ArticulatedInertia<S>& IA = w.IA[i];
    Force<S>& pA = w.pA[i];
    DofFactor<S>* dof = w.dof + iv;
    // Eliminating one direction after the other is the factorisation: each updates IA, so the next pivot is read off it.
    for (int k = 0; k < nv; ++k) {
      const Force<S> U = IA * dof[k].S_;
      const S pivot = dot(dof[k].S_, U) + order.armature(iv + k);
      noteVanishing(pivot, dof[k].S_, IA, i, w.failed);
      const S inverse = S(1) / pivot;
      dof[k].inverse = inverse;
      dof[k].W = U;
      dof[k].y = (tau[iv + k] - dot(dof[k].S_, pA)) / pivot;
      IA.subtractOuter(U, inverse * U);
      pA += dof[k].y * U;
    }
    if (!order.isRoot(i)) {
      pA += IA * w.beta[i];
      order.addToParent(w.IA, i, IA.shifted(w.r[i]));
      order.addToParent(w.pA, i, Force<S>{pA.linear, pA.angular + cross(w.r[i], pA.linear)});
    }
  });
}

/// Accelerations, parents first; within a joint in the reverse order of elimination.
template <class S, class Order>
void abaSolve(const Order& order, Workspace<S>& w, S* ddq) {
  w.acc[0] = {};
  order.forward([&]<class Joint>(const Joint&, int i, int iv) {
    Motion<S> a = order.parent(w.acc, i);
    if (order.isRoot(i)) {
      a.linear = isFlyingRoot<Joint>(order, i) ? transposeTimes(w.rel[i].R, -order.gravity()) : -order.gravity();
    } else {
      a.linear += cross(a.angular, w.r[i]);
    }
    a += w.beta[i];
    for (int k = Joint::nv - 1; k >= 0; --k) {
      const DofFactor<S>& f = w.dof[iv + k];
      ddq[iv + k] = f.y - dot(a, f.W) * f.inverse;
      a += ddq[iv + k] * f.S_;
    }
    w.acc[i] = a;
  });
}

}  // namespace dyn::kernels
