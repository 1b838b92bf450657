// Derivatives of forward dynamics: the articulated-body algorithm differentiated, all columns of a pack at once.
//
// Moving along degree of freedom m, or its velocity, gives its subtree an acceleration b and a turning rate x beside what turning the
// subtree rigidly changes (rnea_derivatives.hpp). What follows of these is forward dynamics without velocities: accelerations start with b
// at joint m, and each body of the subtree bears the Coriolis force that x brings. That force is linear in x, so it is eliminated joint by
// joint as inertias are: an articulated 6 x 3 map. Nothing is divided by M, whose condition would cost digits.
#pragma once

#include "kernels/minverse.hpp"
#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// Of a column w.r.t. q or v in the rows that start at `first`: force handed to the parent (6), acceleration b (6), turning rate x (3).
struct ColumnRows {
  int first;
  static constexpr int size = 15;
  template <class S>
  Rows<S> of(const Rows<S>& rows, int component) const {
    return {rows[first + component], rows.stride};
  }
  template <class S>
  Rows<S> force(const Rows<S>& rows) const {
    return of(rows, 0);
  }
  template <class S>
  Rows<S> acceleration(const Rows<S>& rows) const {
    return of(rows, 6);
  }
  template <class S>
  Rows<S> turning(const Rows<S>& rows) const {
    return of(rows, 12);
  }
};
inline constexpr ColumnRows columns_by_q{0}, columns_by_v{ColumnRows::size};

/// a b^T subtracted.
template <class S>
void subtractOuter(Mat3<S>& from, const Vec3<S>& a, const Vec3<S>& b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) from(i, j) -= a[i] * b[j];
}

/// Of a rigid body: what coriolis() is as a matrix.
template <class S>
CoriolisMap<S> coriolisMap(const SubtreeMotion<S>& c) {
  const S trace = c.K(0, 0) + c.K(1, 1) + c.K(2, 2);
  CoriolisMap<S> map{S(-2) * skew(c.momentum.linear), S(-2) * c.K};
  for (int k = 0; k < 3; ++k) map.angular(k, k) += S(2) * trace;
  return map;
}

/// About the parent's origin, with velocities relative to it: r from the parent's to the joint's, rate the joint origin's velocity.
template <class S>
CoriolisMap<S> shiftedMap(const CoriolisMap<S>& map, const ArticulatedInertia<S>& I, const Vec3<S>& r, const Vec3<S>& rate) {
  const Mat3<S> turned = S(-2) * skew(rate);
  CoriolisMap<S> out{map.linear + I.linear.matrix() * turned, map.angular + transpose(I.coupling) * turned};
  out.angular = out.angular + skew(r) * out.linear;
  return out;
}

/// Factors of the elimination, for factorsSweep too, articulated Coriolis maps and the columns' beginnings; after derivativesOutward, which left
/// rigid inertias and forces in w. w.failed tells lane by lane whether a pivot vanished.
template <class S, class Order>
void abaDerivativesInward(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  for (int& body : w.failed) body = 0;
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    ArticulatedInertia<S> IA = ArticulatedInertia<S>::rigid(w.mass[i], w.h[i], w.Io[i]);
    CoriolisMap<S> map = coriolisMap(d.body[i]);
    if (!order.isLeaf(i)) {
      IA += w.IA[i];
      map = {map.linear + d.coriolis[i].linear, map.angular + d.coriolis[i].angular};
    }
    const Force<S> f = w.f[i];
    for (int k = Joint::nv - 1; k >= 0; --k) {
      const Column<Joint, S> column{w.dof[iv + k].S_};
      const Force<S> W = column.force(IA);
      const S pivot = column.along(W) + order.armature(iv + k);
      noteVanishing(pivot, column, IA, i, w.failed);
      const S inverse = S(1) / pivot;
      keepFactor(d, iv + k, pivot, inverse, inverse * W);
      Vec3<S> lever{};
      if constexpr (Joint::has_linear) lever += transposeTimes(map.linear, column.s.linear);
      if constexpr (Joint::has_angular) lever += transposeTimes(map.angular, column.s.angular);
      lever = inverse * lever;
      w.dof[iv + k].W = inverse * W;
      w.dof[iv + k].inverse = inverse;
      d.dof[iv + k].lever = lever;
      if (k == 0 && order.isRoot(i)) break;
      IA.subtractOuter(W, w.dof[iv + k].W);
      subtractOuter(map.linear, W.linear, lever);
      subtractOuter(map.angular, W.angular, lever);
    }
    for (int m = 0; m < Joint::nv; ++m) {
      const Motion<S>& s = w.dof[iv + m].S_;
      const DofVariation<S>& x = d.dof[iv + m];
      const auto begin = [&](ColumnRows rows, const Motion<S>& acceleration, const Vec3<S>& turning, Force<S> force) {
        if (!order.isRoot(i)) force += IA * acceleration + Force<S>{map.linear * turning, map.angular * turning};
        writeForce(force, rows.force(d.force), iv + m);
        writeVector(acceleration.linear, rows.acceleration(d.force), iv + m);
        writeVector(acceleration.angular, rows.of(d.force, 9), iv + m);
        writeVector(turning, rows.turning(d.force), iv + m);
      };
      begin(columns_by_q, x.acceleration, x.velocity.angular, {cross(s.angular, f.linear), cross(s.angular, f.angular) + cross(s.linear, f.linear)});
      begin(columns_by_v, x.rate, s.angular, {});
    }
    if (order.isRoot(i)) return;
    const Vec3<S>& r = w.r[i];
    order.handOver(d.coriolis, i, shiftedMap(map, IA, r, d.body[i].shift_rate));
    order.handOver(w.IA, i, IA.shifted(r));
    order.addToParent(w.f, i, Force<S>{f.linear, f.angular + cross(r, f.linear)});
  });
}

/// What a pack of columns needs of each body on its way.
template <class Wide>
struct ColumnState {
  Force<Wide> force;
  Motion<Wide> acceleration;
  Vec3<Wide> turning;
};

/// As many columns of d ddq, from `first` on, as a pack has lanes, into the rows of d.scratch.
template <class Wide, class S, class Order>
DYN_RUN_LOOP void abaDerivativesColumns(const Order& order, const Workspace<S>& w, const DerivativeWorkspace<S>& d, ColumnRows rows, int first) {
  const CompactImpl& m = order.m;
  auto* state = reinterpret_cast<ColumnState<Wide>*>(d.panel);
  auto* y = reinterpret_cast<Wide*>(state + m.bodies());
  const int n = m.nvx, last = std::min(first + Part<Wide, S>::width, n) - 1;
  std::fill(y, y + n, Wide(0));
  const auto own = [&](int iv, int nv) { return Part<Wide, S>(first, iv, iv + nv); };
  const auto owns = [&](int iv, int nv) { return iv <= last && iv + nv > first; };

  // Forces, from the columns' joints to the root.
  const auto climb = [&](int i, bool owner) {
    const BodyIndex& x = order.index(i);
    Force<Wide> P = state[i].force;
    for (int k = x.nv - 1; k >= 0; --k) {
      const DofFactor<S>& dof = w.dof[x.idx_v + k];
      const Motion<Wide> s = broadcast<Wide>(dof.S_);
      Wide power = dot(s, P);
      if (owner && d.own_torque.first != nullptr) power += own(x.idx_v, x.nv).inside() * own(x.idx_v, x.nv).load(d.own_torque[k]);
      const Wide solution = -(Wide(dof.inverse) * power);
      y[x.idx_v + k] = solution;
      // W holds the inverse already.
      const Wide along = -power;
      P += Force<Wide>{along * broadcast<Wide>(dof.W.linear), along * broadcast<Wide>(dof.W.angular)};
    }
    if (x.parent == 0) return;
    if (owner) {
      const Part<Wide, S> part = own(x.idx_v, x.nv);
      P += part.inside() * loadForce(part, rows.force(d.force));
    }
    const Vec3<Wide> r = broadcast<Wide>(w.r[i]);
    state[x.parent].force += Force<Wide>{P.linear, P.angular + cross(r, P.linear)};
  };
  const int begin = m.dof_body[static_cast<std::size_t>(first)], end = m.dof_body[static_cast<std::size_t>(last)];
  for (int i = end; i > 0; i = i > begin ? i - 1 : order.parentOf(i)) state[i].force = {};
  for (int i = end; i > 0; i = i > begin ? i - 1 : order.parentOf(i)) climb(i, i >= begin);

  // Accelerations, from the root outward.
  state[0].acceleration = {};
  state[0].turning = {};
  order.forward([&]<class Joint>(const Joint&, int i, int iv) {
    const ColumnState<Wide>& parent = state[order.parentOf(i)];
    Motion<Wide> a = parent.acceleration;
    Vec3<Wide> turning = parent.turning;
    if (!order.isRoot(i)) a.linear += cross(a.angular, broadcast<Wide>(w.r[i])) + cross(turning, broadcast<Wide>(S(2) * d.body[i].shift_rate));
    if (owns(iv, Joint::nv)) {
      const Part<Wide, S> part = own(iv, Joint::nv);
      const Wide inside = part.inside();
      a += inside * Motion<Wide>{loadVector(part, rows.acceleration(d.force)), loadVector(part, rows.of(d.force, 9))};
      turning += inside * loadVector(part, rows.turning(d.force));
    }
    for (int k = 0; k < Joint::nv; ++k) {
      const DofFactor<S>& dof = w.dof[iv + k];
      const Wide x = y[iv + k] - dot(a, Force<Wide>{broadcast<Wide>(dof.W.linear), broadcast<Wide>(dof.W.angular)}) -
                     dot(broadcast<Wide>(d.dof[iv + k].lever), turning);
      if constexpr (Joint::has_linear) a.linear += x * broadcast<Wide>(dof.S_.linear);
      if constexpr (Joint::has_angular) a.angular += x * broadcast<Wide>(dof.S_.angular);
      own(iv, Joint::nv).store(x, d.scratch[iv + k]);
    }
    state[i].acceleration = a;
    state[i].turning = turning;
  });
}

/// The joints' own torques of varying subspaces: entry (k, m) of -d tau_k / dq_m at constant force.
template <class S, class Order>
void ownTorques(const Order& order, const Workspace<S>& w, DerivativeWorkspace<S>& d) {
  order.forward([&]<class Joint>(const Joint&, int i, int iv) {
    for (int k = 0; k < Joint::nv; ++k)
      for (int m = 0; m < Joint::nv; ++m) {
        S torque(0);
        if constexpr (Joint::has_bias) {
          const BodyIndex& x = order.index(i);
          const Motion<S> dS = d.subspaces[x.batch].column(Joint::nv, m, k, x.slot);
          torque = dot(Motion<S>{w.R[i] * dS.linear, w.R[i] * dS.angular}, w.f[i]);
        }
        d.own_torque[k][iv + m] = torque;
      }
  });
}

/// Derivative of aba by q or by v, n x n, into the columns of `out`; losses are not in it.
template <class Wide, class Panel, class S, class Order>
void abaDerivatives(const Order& order, const Workspace<S>& w, const DerivativeWorkspace<S>& d, bool by_q, const Rows<S>& out) {
  DerivativeWorkspace<S> mine = d;
  if (!by_q) mine.own_torque.first = nullptr;
  for (int first = 0; first < order.m.nvx; first += Part<Panel, S>::width)
    abaDerivativesColumns<Panel>(order, w, mine, by_q ? columns_by_q : columns_by_v, first);
  transpose<Wide>(d.scratch, order.m.nvx, out);
}

}  // namespace dyn::kernels
