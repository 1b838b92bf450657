// Derivatives of forward dynamics: the articulated-body algorithm differentiated.
//
// Moving along degree of freedom m, or its velocity, gives its subtree an acceleration b and a turning rate x beside what turning the
// subtree rigidly changes (rnea_derivatives.hpp). What follows of these is forward dynamics without velocities: accelerations start with b
// at joint m, and each body of the subtree bears the Coriolis force that x brings. That force is linear in x, so it is eliminated joint by
// joint as inertias are: an articulated 6 x 3 map. A joint i of the subtree then accelerates by
//   -(IA s_i / pivot . b + lever_i . x)
// less what its path's accelerations make of it, and a joint k on the way to the root gets the force that the subtree hands over: rows of
// L^T D L, whose factors are those of M. Nothing is divided by M, whose condition would cost digits.
#pragma once

#include "kernels/minverse.hpp"
#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// Of a rigid body: what coriolis() is as a matrix.
template <class S>
CoriolisMap<S> coriolisMap(const Vec3<S>& momentum, const Mat3<S>& K) {
  return {skew(S(-2) * momentum), S(2) * (trace(K) * Mat3<S>::identity() - K)};
}

/// About the parent's origin, with velocities relative to it: r from the parent's to the joint's, rate the joint origin's velocity.
template <class S>
CoriolisMap<S> shiftedMap(const CoriolisMap<S>& map, const ArticulatedInertia<S>& I, const Vec3<S>& r, const Vec3<S>& rate) {
  const Vec3<S> turning = S(-2) * rate;
  const Mat3<S> linear = map.linear + timesSkew(I.linear.matrix(), turning);
  return {linear, map.angular + timesSkew(transpose(I.coupling), turning) + crossColumns(r, linear)};
}

/// Placements, velocities and columns, and w.beta.
template <class Order, class S>
void movingOutward(const Order& order, DerivativeWorkspace<S>& d, const S* v) {
  Workspace<S>& w = order.w;
  w.w[0] = {};
  order.forward(passing(w.w, w.R, w.product), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&&... axes) {
    const Vec3<S>& wp = turning.get();
    const auto [R, s, omega] = moveAligned<S>(joint, order, i, d, v + iv, wp, axes...);
    for (int k = 0; k < Joint::nv; ++k) w.dof[iv + k].S_ = joint.columnIn(R, k);
    w.beta[i] = velocityAcceleration(joint, R, w.r[i], wp, omega, s);
    turning.leave(omega);
  });
}

/// Factors of the elimination, the columns' beginnings, of each body what moves it but for its acceleration, and what of the accelerations the forces
/// tau and the velocities say, into w.dof's y; then w.IA and d.coriolis have what each body is to its parent. w.failed tells lane by lane whether a
/// pivot vanished.
template <class Order, class S, class T>
void articulatedInward(const Order& order, DerivativeWorkspace<S>& d, const S* tau, const Force<T>* fext) {
  Workspace<S>& w = order.w;
  for (int& body : w.failed) body = 0;
  const auto articulated = passing(d.coriolis, w.IA, w.pA);
  order.backward(articulated, [&]<class Joint>(const Joint&, int i, int iv, auto&& coriolis, auto&& inertia, auto&& force) {
    const Subtree<S> own = movingBody<Joint>(order, w, i, fext);
    d.subtree[i] = own;
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(own.m.mass, own.m.h, own.m.I));
    CoriolisMap<S> map = coriolis.with(coriolisMap(own.m.momentum.linear, own.K));
    Force<S> pA = force.with(own.f);
    eliminateJoint<Joint>(order, w, IA, i, iv, [&](int k, const auto& column, const Force<S>& W, const S& inverse, const Force<S>& row) {
      const S y = tau[iv + k] - column.along(pA);
      w.dof[iv + k].y = inverse * y;
      pA += y * row;
      d.factors.inverse[iv + k] = inverse;
      const Vec3<S> lever = inverse * column.along(map.linear, map.angular);
      d.dof_force[iv + k].by_a = row;
      d.dof_force[iv + k].lever = lever;
      map.linear = map.linear - outer(W.linear, lever);
      map.angular = map.angular - outer(W.angular, lever);
    });
    if (order.isRoot(i)) return;
    w.IA[i] = IA;
    d.coriolis[i] = map;
    pA += IA * w.beta[i];
    const Vec3<S>& r = w.r[i];
    coriolis.give(shiftedMap(map, IA, r, d.shift_rate[i]));
    inertia.give(IA.shifted(r));
    force.give({pA.linear, pA.angular + cross(r, pA.linear)});
  });
}

/// Accelerations ddq, and with them the bodies' forces and the degrees of freedom's variations. Within a joint in the reverse order of
/// elimination.
template <class Order, class S>
void acceleratingOutward(const Order& order, DerivativeWorkspace<S>& d, const S* v, S* ddq) {
  Workspace<S>& w = order.w;
  order.forward(passing(w.acc), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& accelerated) {
    const Motion<S> carried = carriedAcceleration<Joint>(order, i, accelerated.get(), order.gravity());
    Motion<S> acc = carried + w.beta[i];
    withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
      for (int k = 0; k < Joint::nv; ++k) {
        const S x = w.dof[iv + k].y - dot(acc, d.dof_force[iv + k].by_a);
        ddq[iv + k] = x;
        column(k).addTo(acc, x);
      }
    });
    Vec3<S> slide{};
    if constexpr (Joint::has_linear) slide = joint.timesIn(w.R[i], v + iv).linear;
    d.subtree[i].f += rigidForce(d.subtree[i].m, acc);
    writeVariations<Joint>(order, d, i, iv, order.parent(w.w, i), w.w[i], carried, slide, v, static_cast<const S*>(ddq));
    accelerated.leave(acc);
  });
}

/// What each column hands to its body's parent; by q the subtree's force turns, too.
template <class Order, class S>
void variationsInward(const Order& order, DerivativeWorkspace<S>& d) {
  Workspace<S>& w = order.w;
  order.backward(passing(w.f), [&]<class Joint>(const Joint&, int i, int iv, auto&& force) {
    const Force<S>& f = force.gather(d.subtree[i].f);
    if (order.isRoot(i)) return;
    const ArticulatedInertia<S>& IA = w.IA[i];
    const CoriolisMap<S>& map = d.coriolis[i];
    for (int m = 0; m < Joint::nv; ++m) {
      const Motion<S>& s = w.dof[iv + m].S_;
      const DofVariation<S>& x = d.dof[iv + m];
      const auto handed = [&](const Motion<S>& acceleration, const Vec3<S>& turning) {
        return IA * acceleration + Force<S>{map.linear * turning, map.angular * turning};
      };
      d.dof_force[iv + m].by_q = handed(x.acceleration, x.velocity.angular) + turnedOf<Joint>(s, f);
      d.dof_force[iv + m].by_v = handed(x.rate, s.angular);
    }
    force.give({f.linear, f.angular + cross(w.r[i], f.linear)});
  });
}

/// After pathSweep: what the torques s . f of subspaces that vary with q add to by_q. They are eliminated within the joint, and what is left
/// of them on its path.
template <bool open, class R, class S>
void eliminateSubspaceTorques(const R& recursion, DerivativeWorkspace<S>& d, const PathMatrix<S>& by_q) {
  const auto& order = recursion.order;
  const Rows<S>& L = d.by_a.below;
  order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    if constexpr (Joint::has_bias)
      for (int m = iv; m < iv + Joint::nv; ++m) {
        S torque[Joint::nv];
        for (int k = Joint::nv - 1; k >= 0; --k) {
          torque[k] = numberOf(subspaceTorque<Joint>(order, recursion.d, order.w.f[i], i, m - iv, k));
          for (int l = k + 1; l < Joint::nv; ++l) torque[k] -= L[iv + k][iv + l] * torque[l];
        }
        alongPath(order.m, order.m.dof_parent[static_cast<std::size_t>(iv)], [&](int j) {
          for (int k = 0; k < Joint::nv; ++k) by_q.rightOf(j, m) -= L[j][iv + k] * torque[k];
        });
        for (int k = 0; k < Joint::nv; ++k) by_q.template addOwn<open>(iv + k, m, d.factors.inverse[iv + k] * torque[k]);
      }
  });
}

// Rows of by_q and by_v have forces right of a joint's own columns; the joint's own, and those of its path, have accelerations already. All have the
// other sign.

/// Accelerations ddq under the forces tau, the beginnings of their derivatives by_q and by_v, and the factors of M, d.by_a and d.factors. Joints have
/// been asked into w, how subspaces vary into d. w.failed tells lane by lane whether a pivot vanished. Where joints are left open (PathMatrix), by_v
/// has damping.
template <class Wide, bool open, class S>
void abaDerivativesSweep(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* tau, S* ddq, const Force<S>* fext,
                         const PathMatrix<S>& by_q, const PathMatrix<S>& by_v) {
  const auto r = recursion(m, w, d);
  movingOutward(r.order, r.d, r.in(v));
  articulatedInward(r.order, r.d, r.in(tau), fext);
  acceleratingOutward(r.order, r.d, r.in(v), r.out(ddq));
  variationsInward(r.order, r.d);
  pathSweep<Wide>(r, d, by_q, by_v);
  if constexpr (open) {
    by_q.leaveJointsOpen(m, nullptr);
    by_v.leaveJointsOpen(m, m.damping.empty() ? nullptr : m.damping.data());
  } else {
    closeJoints(m, d);
  }
  eliminateSubspaceTorques<open>(r, d, by_q);
  r.failures(w.failed);
}
/// Into d.by_q and d.by_v, for abaDerivative and abaDerivativeColumns.
template <class S>
void abaDerivativesSweep(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* tau, S* ddq) {
  abaDerivativesSweep<S, false>(m, w, d, v, tau, ddq, static_cast<const Force<S>*>(nullptr), d.by_q, d.by_v);
}

/// Where a state's derivatives of accelerations are wanted, n x n each. That by tau is M^-1.
struct AccelerationDerivatives {
  double *by_q, *by_v, *by_tau;
};
/// ddq and its derivatives of one state: all solved for together, side by side in d.sides. tau is without losses, the derivatives are with
/// them.
template <class Wide>
void abaDerivatives(const CompactImpl& m, Workspace<double>& w, DerivativeWorkspace<double>& d, const double* v, const double* tau,
                    const Force<double>* fext, double* ddq, const AccelerationDerivatives& out) {
  const int n = m.nvx;
  const SideBySide<double> X = d.sides;
  const PathMatrix<double> by_q{d.by_q.below, X[1]}, by_v{d.by_v.below, X[2]};
  for (int i = 0; i < n; ++i)
    for (std::ptrdiff_t k = 0; k < X.matrices * X.apart; k += lanes_of<Wide>) storePack(Wide(0), X.rows[i] + k);
  abaDerivativesSweep<Wide, true>(m, w, d, v, tau, ddq, fext, by_q, by_v);
  for (int i = 0; i < n; ++i) X[0][i][i] = 1;
  const TreeSystem<double> system{m, d.by_a.below, d.factors.inverse};
  solveUpper<Wide, X.matrices>(system, X.rows, X.apart, wholeBlocks);
  by_q.addBelowTo<Wide>(m, X[1]);
  by_v.addBelowTo<Wide>(m, X[2]);
  // Half of the first one is solved for: it is symmetric to the last bit.
  solveLower<Wide>(system, X.rows, X.rows, static_cast<int>(2 * X.apart) + n, true);
  mirrorUpper<Wide>(X[0], n, Rows<double>{out.by_tau, n});
  writeMinusTransposed<Wide>(X[1], n, Rows<double>{out.by_q, n});
  writeMinusTransposed<Wide>(X[2], n, Rows<double>{out.by_v, n});
}

/// Derivative of aba in lanes, losses not in it, from its beginnings, which are n x n and change.
template <class S>
void abaDerivative(const CompactImpl& m, const DerivativeWorkspace<S>& d, S* beginnings, S* out) {
  const int n = m.nvx;
  const TreeSystem<S> system{m, d.by_a.below, d.factors.inverse};
  const ByColumns<S> B{beginnings, n}, X{out, n};
  solveUpper<S>(system, B, 0, [&](int column) { return system.jointBegin(column); });
  solveLower<S, true>(system, B, X, n, false);
}
/// The same column by column, into columns of zeros: with nothing done twice, and nothing for zeros.
template <class S, class Order>
void abaDerivativeColumns(const Order& order, const DerivativeWorkspace<S>& d, const PathMatrix<S>& by, const Rows<S>& out) {
  const CompactImpl& m = order.m;
  const TreeSystem<S> system{m, d.by_a.below, d.factors.inverse};
  const auto begin = [&](int i) { return system.jointEnd(i); };
  by.template assemble<S>(m.dof_end, out);
  order.eachDof(0, m.nvx, [&](int k) {
    solveColumn(system, order, begin, k, m.nvx, out[k]);
    for (int i = 0; i < m.nvx; ++i) {
      order.goesDown(i);
      out[k][i] = -out[k][i];
    }
  });
}

}  // namespace dyn::kernels
