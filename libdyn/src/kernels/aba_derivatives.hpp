// Derivatives of forward dynamics: the articulated-body algorithm differentiated.
//
// Moving along degree of freedom m, or its velocity, gives its subtree an acceleration b and a turning rate x beside what turning the
// subtree rigidly changes (rnea_derivatives.hpp). What follows of these is forward dynamics without velocities: accelerations start with b
// at joint m, and each body of the subtree bears the Coriolis force that x brings. That force is linear in x, so it is eliminated joint by
// joint as inertias are: an articulated 6 x 3 map. A joint i of the subtree then accelerates by
//   -(IA s_i / pivot . b + lever_i . x)
// of which the joints from there up to m have taken their shares on the way; and a joint k on the way to the root gets its share of the
// force that the subtree hands over, which moves all joints as torques do: the rest of the way down is the same as that of M^-1.
#pragma once

#include "kernels/minverse.hpp"
#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// Of a rigid body: what coriolis() is as a matrix.
template <class S>
CoriolisMap<S> coriolisMap(const Vec3<S>& momentum, const Mat3<S>& K) {
  return {skew(S(-2) * momentum), S(2) * turningTorque(K)};
}

/// About the parent's origin, with velocities relative to it: r from the parent's to the joint's, rate the joint origin's velocity. I() is where the
/// inertia is read.
template <class S, class Again>
void moveMap(const CoriolisMap<S>& map, const Again& I, const Vec3<S>& r, const Vec3<S>& rate, CoriolisMap<S>& to) {
  const Vec3<S> turning = S(-2) * rate;
  to.linear = map.linear + timesSkew(I().linear.matrix(), turning);
  to.angular = map.angular + timesSkew(transpose(I().coupling), turning) + crossColumns(r, to.linear);
}

/// Placements, velocities and columns, and w.beta.
template <class Order, class S>
void movingOutward(const Order& order, DerivativeWorkspace<S>& d, const S* v) {
  Workspace<S>& w = order.w;
  w.w[0] = {};
  order.forward(passingAxes(order, w, w.w), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& turning, auto&&... axes) {
    const Vec3<S>& wp = turning.get();
    const auto [R, s, omega] = moveAligned<S, Renewal::whole>(joint, order, i, d, v + iv, wp, axes...);
    writeColumns(joint, R, w.dof + iv);
    w.beta[i] = velocityAcceleration(joint, order, i, R, wp, omega, s);
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
    Subtree<S>& own = d.subtree[i];
    writeMomentum<Joint>(order, w, i, own.m);
    const auto m = [&]() -> const SubtreeMomentum<S>& { return readAgain(order, own.m); };
    own.f = movingForce(w, i, m(), fext);
    own.K = turnedMoment(m(), w.w[i]);
    CoriolisMap<S>& map = d.coriolis[i];  // in memory: there are not enough registers for it and IA
    coriolis.gather(coriolisMap(m().momentum.linear, readAgain(order, own.K)));
    Force<S> pA = force.with(readAgain(order, own.f));
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(m().mass, m().h, m().I));
    eliminateJoint<Joint>(order, w, IA, i, iv, [&](int k, const auto& column, const Force<S>& W, const S& inverse, const Force<S>& row) {
      const S y = tau[iv + k] - column.along(pA);
      w.dof[iv + k].y = inverse * y;
      pA += y * row;
      d.factors.inverse[iv + k] = inverse;
      const Vec3<S> lever = inverse * column.along(readAgain(order, map).linear, map.angular);
      d.dof_force[iv + k].by_a = row;
      d.dof_force[iv + k].lever = lever;
      map.linear = map.linear - outer(W.linear, lever);
      map.angular = map.angular - outer(W.angular, lever);
    });
    if (order.isRoot(i)) return;
    w.IA[i] = IA;
    const auto left = [&]() -> const ArticulatedInertia<S>& { return readAgain(order, w.IA[i]); };
    pA += left() * w.beta[i];
    if (order.hasLever(i)) {
      const Vec3<S>& r = w.r[i];
      coriolis.giveInPlace([&](CoriolisMap<S>& to) { moveMap(readAgain(order, map), left, r, d.shift_rate[i], to); });
      inertia.giveInPlace([&](ArticulatedInertia<S>& to) { to = left().shifted(r); });
      addCross(pA.angular, r, pA.linear);
    } else {
      coriolis.give(readAgain(order, map));
      inertia.give(left());
    }
    force.give(pA);
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
    force.give({f.linear, f.angular + ofLever<S>(order, i, [&] { return cross(w.r[i], f.linear); })});
  });
}

/// What articulatedSweep has entered into by_q, below or right, of degree of freedom k and j of its subtree.
template <class S>
S& entryByQ(const CompactImpl& m, const DerivativeWorkspace<S>& d, typename PathPairs<S>::Number side, int k, int j) {
  if constexpr (in_pairs<S>) {
    return d.pairs.row(j, m.dof_depth[static_cast<std::size_t>(k)])[side];
  } else {
    return (side == PathPairs<S>::q_right ? d.by_q.right : d.by_q.below)[k][j];
  }
}

/// To by_q: the torques s . f of subspaces that vary. Joints on the way to the root get of them what U says.
template <class R, class S>
void addSubspaceTorques(const R& recursion, const DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  const Rows<S> U = d.factors.U;
  order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    if constexpr (Joint::has_bias)
      for (int j = iv; j < iv + Joint::nv; ++j) {
        S torque[Joint::nv];
        for (int l = 0; l < Joint::nv; ++l) torque[l] = numberOf(subspaceTorque<Joint>(order, recursion.d, order.w.f[i], i, j - iv, l));
        alongPath(order.m, iv + Joint::nv - 1, [&](int k) {
          S share(0);
          for (int l = std::max(k - iv, 0); l < Joint::nv; ++l) share += torque[l] * U[k][iv + l];
          if (k <= j) {
            entryByQ<S>(order.m, d, PathPairs<S>::q_right, k, j) -= share;
          } else {
            // The joint's own after j, which products of factors take from their beginnings.
            share *= d.factors.inverse[k];
            for (int other = k; other < order.dofEnd(i); ++other) entryByQ<S>(order.m, d, PathPairs<S>::q_below, j, other) += share * U[k][other];
          }
        });
      }
  });
}
/// Accelerations ddq under the forces tau, and what their derivatives are made of, losses included: d.by_q, d.by_v and d.factors. Joints have been
/// asked into w, how subspaces vary into d. w.failed tells lane by lane whether a pivot vanished.
template <class Wide, class R, class S>
void abaDerivativesSweep(const R& r, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* tau, S* ddq, const Force<S>* fext = nullptr) {
  movingOutward(r.order, r.d, r.in(v));
  articulatedInward(r.order, r.d, r.in(tau), fext);
  acceleratingOutward(r.order, r.d, r.in(v), r.out(ddq));
  variationsInward(r.order, r.d);
  articulatedSweep<Wide>(r, d);
  addSubspaceTorques(r, d);
  r.failures(w.failed);
}

/// After the sweep: the derivative that one of d.by_q and d.by_v is made into, n x n.
template <class Wide, class S>
void accelerationBy(const CompactImpl& m, const TreeFactors<S>& factors, const PathMatrix<S>& by, const Rows<S>& out) {
  downTheTree<Wide, false>(m, factors, by.right, FromMinus<S>{by.below}, out);
}
/// The same of states in packs, some columns at a time into `out`, whose rows are one after the other: put(begin, count) is called for these.
template <class S, class Put>
void accelerationBy(const CompactImpl& m, const TreeFactors<S>& factors, const ProductScratch<S>& scratch, const PathPairs<S>& pairs,
                    typename PathPairs<S>::Number below, S* out, Put&& put) {
  inChains(m, factors, scratch, [&]<int columns>(const ChainProduct<S>& chain, int j) {
    const std::ptrdiff_t n = m.nvx;
    const S* right[columns];
    for (int c = 0; c < columns; ++c) right[c] = pairs.row(j + c, 0) + PathPairs<S>::rightOf(below);
    const auto rightOf = [&](int c, int depth) -> const S& { return right[c][PathPairs<S>::numbers * depth]; };
    chain.template write<columns>(j, 0, rightOf, OtherSign<S, columns>(m, pairs, below, j), [=]<int rows>(const S(&sum)[columns][rows], int first) {
#pragma GCC unroll 6
      for (int c = 0; c < columns; ++c)
#pragma GCC unroll 4
        for (int r = 0; r < rows; ++r) out[c * n + first + r] = sum[c][r];
    });
    put(j, columns);
  });
}

/// Where a state's derivatives of accelerations are wanted, n x n each. That by tau is M^-1.
struct AccelerationDerivatives {
  double *by_q, *by_v, *by_tau;
};
/// ddq and its derivatives of one state, over bodies: measured, it takes no less over strips. tau is without losses, the derivatives are with them.
template <class Wide>
void abaDerivatives(const CompactImpl& m, Workspace<double>& w, DerivativeWorkspace<double>& d, const double* v, const double* tau,
                    const Force<double>* fext, double* ddq, const AccelerationDerivatives& out) {
  abaDerivativesSweep<Wide>(recursion(m, w, d), w, d, v, tau, ddq, fext);
  inverseOfMassMatrix<Wide>(m, d.factors, Rows<double>{out.by_tau, m.nvx});
  accelerationBy<Wide>(m, d.factors, d.by_q, Rows<double>{out.by_q, m.nvx});
  accelerationBy<Wide>(m, d.factors, d.by_v, Rows<double>{out.by_v, m.nvx});
}

}  // namespace dyn::kernels
