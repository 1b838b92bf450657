// The articulated-body algorithm in aligned frames (Featherstone 2008, ch. 7), with classical accelerations.
#pragma once

#include "kernels/aligned.hpp"
#include "kernels/pivots.hpp"

#include <algorithm>
#include <limits>

namespace dyn::kernels {

/// Poses, velocities and what they make of accelerations.
template <class S, class Order>
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

/// A pivot that is not above the rounding of what was subtracted to get it is zero. The yardstick is the inertia left in this and other
/// directions at the same body, so it scales with the model's units. Notes the body, lane by lane.
template <class S>
void noteVanishing(const S& pivot, const S& inertia, int body, int* failed) {
  noteSmall(pivot, S(4 * std::numeric_limits<Real<S>>::epsilon()) * inertia, body, failed);
}
template <class S, class Column>
void noteVanishing(const S& pivot, const Column& column, const ArticulatedInertia<S>& I, int body, int* failed) {
  noteVanishing(pivot, column.weighted(trace(I.linear), trace(I.angular)), body, failed);
}

/// Factor of one degree of freedom, k of the model's, of body i.
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

/// Whether a root flies and leaves nothing behind in directions that are eliminated, as armature does, which accelerates but does not fall.
template <class Joint, class Order>
bool isBareRoot(const Order& order, int i) {
  return isFlyingRoot<Joint>(order, i) && !order.m.roots_have_armature;
}

/// A bare root's directions are its axes: its inertia is the matrix that they are eliminated from, one after the other, the last or the first one
/// first. Products are made before the pivots that they wait to be divided by.
template <bool last_first, class S>
class AxesElimination {
 public:
  template <class Order>
  AxesElimination(const Order& order, const ArticulatedInertia<S>& IA, int i, int iv, int* failed) {
#pragma GCC unroll 6
    for (int r = 0; r < 6; ++r)
#pragma GCC unroll 6
      for (int c = 0; c <= r; ++c) left_[r][c] = entry(IA, std::max(axis(r), axis(c)), std::min(axis(r), axis(c)));
#pragma GCC unroll 6
    for (int p = 0; p < 6; ++p) {
      // What is left in this direction and the others of its three.
      S three = left_[p][p];
      for (int r = p + 1; r < (p < 3 ? 3 : 6); ++r) three += left_[r][r];
      // Strips have armature in lanes of nobody.
      const S pivot = left_[p][p] + order.armature(iv + axis(p));
      noteVanishing(pivot, three, i, failed);
      inverse_[p] = S(1) / pivot;
#pragma GCC unroll 6
      for (int r = p + 1; r < 6; ++r)
#pragma GCC unroll 6
        for (int c = p + 1; c <= r; ++c) left_[r][c] -= left_[r][p] * left_[c][p] * inverse_[p];
    }
  }

  /// What is eliminated p-th; and when axis p is.
  static constexpr int axis(int p) { return last_first ? 5 - p : p; }
  const S& inverse(int p) const { return inverse_[p]; }
  /// Column p of what was left, against axis r.
  const S& left(int r, int p) const { return left_[r][p]; }
  Force<S> column(int p) const {
    const auto along = [&](int d) { return axis(d) < p ? S(0) : left_[axis(d)][p]; };
    return {{along(0), along(1), along(2)}, {along(3), along(4), along(5)}};
  }

 private:
  static S entry(const ArticulatedInertia<S>& I, int r, int c) {
    if (r < 3) return I.linear.matrix().col(c)[r];
    return c < 3 ? I.coupling.row(c)[r - 3] : I.angular.matrix().col(c - 3)[r - 3];
  }
  S left_[6][6], inverse_[6];
};

/// An articulated inertia and the force that goes with it, about a point from which the one before is at r.
template <class S>
void shift(ArticulatedInertia<S>& IA, Force<S>& f, const Vec3<S>& r) {
  IA = IA.shifted(r);
  addCross(f.angular, r, f.linear);
}

/// abaInward at a bare root.
template <class S, class Order>
void eliminateBareRoot(const Order& order, const ArticulatedInertia<S>& IA, const Force<S>& pA, const S* tau, int i, int iv, Workspace<S>& w) {
  const AxesElimination<false, S> axes(order, IA, i, iv, w.failed);
  S rest[6];
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) rest[k] = tau[k] - UnitColumn<S>{k}.along(pA);
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k) {
    const S y = rest[k] * axes.inverse(k);
#pragma GCC unroll 6
    for (int r = k + 1; r < 6; ++r) rest[r] -= y * axes.left(r, k);
    w.dof[iv + k].y = y;
    w.dof[iv + k].W = axes.column(k);
    w.dof[iv + k].inverse = axes.inverse(k);
  }
}

/// Eliminates each degree of freedom (pivot S^T IA S + armature), projects inertia and bias force, hands them to the parent.
/// w.failed tells lane by lane whether a pivot vanished.
template <class S, class Order>
void abaInward(const Order& order, Workspace<S>& w, const S* tau, const Force<S>* fext = nullptr) {
  for (int& body : w.failed) body = 0;
  order.backward(passing(w.IA, w.pA), [&]<class Joint>(const Joint&, int i, int iv, auto&& inertia, auto&& force) {
    const auto [mass, h, I] = alignedInertia<Joint>(order, w, i);
    const Vec3<S>& omega = w.w[i];
    Force<S> own{cross(omega, cross(omega, h)), cross(omega, I * omega)};
    if (fext) own -= inAlignedAxes(w, i, fext[i]);
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(mass, h, I));
    Force<S> pA = force.with(own);
    // Eliminating one direction after the other is the factorisation: each updates IA, so the next pivot is read off it. At the joint's
    // origin, before the shift: the projection cancels, and what it leaves must not be lost under larger numbers.
    const int last = nvOf<Joint>(order, i) - 1;
    if (isBareRoot<Joint>(order, i)) {
      if constexpr (Joint::is_free) eliminateBareRoot(order, IA, pA, tau + iv, i, iv, w);
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
    // The last direction is solved for first, from the parent's acceleration.
    DofFactor<S>& dof = w.dof[iv + last];
    const Motion<S>& beta = w.beta[i];
    const Vec3<S>& r = w.r[i];
    dof.y -= dof.inverse * dot(beta, dof.W);
    dof.W = dof.inverse * Force<S>{dof.W.linear, dof.W.angular + cross(r, dof.W.linear)};
    if (order.isRoot(i)) return;
    pA += IA * beta;
    if (order.hasLever(i)) shift(IA, pA, r);
    inertia.give(IA);
    force.give(pA);
  });
}

/// Accelerations under this gravity, parents first; within a joint in the reverse order of elimination.
template <class S, class Order>
void abaSolve(const Order& order, Workspace<S>& w, const Vec3<S>& gravity, S* ddq) {
  w.acc[0] = {};
  order.forward(passing(w.acc), [&]<class Joint>(const Joint&, int i, int iv, auto&& acceleration) {
    Motion<S> parent = acceleration.get();
    if (order.isRoot(i)) parent.linear = isFlyingRoot<Joint>(order, i) ? transposeTimes(w.rel[i].R, -gravity) : -gravity;
    const int last = nvOf<Joint>(order, i) - 1;
    const S x = w.dof[iv + last].y - dot(parent, w.dof[iv + last].W);
    Motion<S> a = parent + w.beta[i];
    if (!order.isRoot(i)) a.linear += leverRate(order, i, parent.angular);
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
