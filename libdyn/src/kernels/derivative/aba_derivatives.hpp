// SPDX-License-Identifier: BSD-2-Clause
// Derivatives of forward dynamics, a = M(q)^-1 (tau - C(q, v) v - g(q)), by q, v and tau: the articulated-body algorithm (Featherstone 2008, ch. 7;
// aba.hpp) differentiated. O(n depth) for the sweeps, O(n^2 depth) at most for the products (11).
//
// Moving along degree of freedom k, or its velocity, gives its subtree an acceleration b and a rotation rate x, in addition to the rigid rotation of
// the subtree: (b, x) = (acceleration, velocity.angular) by q, and (rate, S_w) by v (rnea_derivatives.hpp (2) to (4), whose letters hold here, too).
// Their effect is forward dynamics at zero velocity: accelerations start with b at the joint of k, and each body of the subtree bears a Coriolis
// force that is linear in x. So the elimination of the joints applies to it as to inertias, which gives an articulated 6 x 3 map C.
//
// Inward, with IA and pA as in aba.hpp (3) and (4), momentum and K of rnea_derivatives.hpp (5) for the body alone:
//   (1)  C = (-2 [momentum.linear]x, 2 (tr K - K)) + sum over children of C'            force C x = (C.linear x, C.angular x)
//   for each degree of freedom k of the joint in turn, the last one first:
//   (2)  W = IA S,   D = S^T W + armature,   row = W / D,   y = (tau_k - S^T pA) / D,   offset = S^T C / D
//   (3)  IA -= W W^T / D,   pA += y W,   C -= row (S^T C)
//   (4)  pA += IA beta;   IA', pA' = IA, pA moved by r to the parent's origin
//   (5)  C' = C - 2 (IA.linear [shift_rate]x, IA.coupling^T [shift_rate]x),   then C'.angular += r x C'.linear, column by column
// Outward, from origin_0 = -gravity, with carried = (origin_p + domega_p x r, domega_p) and a = carried + beta:
//   (6)  ddq_k = y - row . a,   a += S ddq_k                                             the first degree of freedom of a joint first
//   (7)  f = IA carried + pA                                                            force through the joint
//   (8)  by_q = IA acceleration + C velocity.angular + (S_w x f.linear, S_w x f.angular + S_v x f.linear),   by_v = IA rate + C S_w
// (7) and (8) take IA, pA and C after (4), before they are moved. For each degree of freedom j, U, offset, by_q and by_v then go to the root, where
// U starts as row_j and U(j, j) = -1. At each joint, for each of its degrees of freedom k, the last one first:
//   (9)  U(k, j) = S_k . U for k < j,   U -= U(k, j) row_k,   offset -= U(k, j) offset_k
//        right_q(k, j) = S_k . by_q,   by_q -= right_q(k, j) row_k,   the same for v;   within j's own joint right_q and right_v start as 0
//        then for each k:  below_q(j, k) = acceleration_k . U + velocity_k.angular . offset,   below_v(j, k) = rate_k . U + S_w,k . offset
//        and to the parent's origin as in rnea_derivatives.hpp (14), U in the place of by_a
//  (10)  right_v(k, j) -= damping_j U(k, j),   and with t_l = dS_l/dq_j . f of j's joint, if its subspace varies:
//        right_q(k, j) -= sum_l U(k, l) t_l for k <= j,   below_q(i, j) += sum_k U(k, i) / D_k sum_l U(k, l) t_l for k > j of j's joint
//  (11)  dddq_i/dq_j = -below_q(i, j) + sum_k U(k, i) / D_k right_q(k, j),   the same for v;   dddq/dtau = M^-1 (minverse.hpp)
//        below(i, j) is zero outside j's subtree, apart from j's whole joint; k: the degrees of freedom whose subtrees have both i and j
#pragma once

#include "kernels/derivative/minverse.hpp"
#include "kernels/derivative/rnea_derivatives.hpp"

namespace dyn::kernels {

/// The matrix of coriolis() for a rigid body, the first term of (1).
template <class S>
CoriolisMap<S> coriolisMap(const Vec3<S>& momentum, const Mat3<S>& K) {
  return {skew(S(-2) * momentum), S(2) * turningTorque(K)};
}

/// (5): C about the parent's origin, with velocities relative to that origin. r: from the parent's origin to the joint's; rate: the velocity of the
/// joint's origin relative to the parent's. I() returns the articulated inertia.
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
    const auto [R, s, omega] = moveAligned<S, Orthonormalisation::whole>(joint, order, i, d, v + iv, wp, axes...);
    writeColumns(joint, R, w.dof + iv);
    w.beta[i] = velocityAcceleration(joint, order, i, R, wp, omega, s);
    turning.leave(omega);
  });
}

/// (1) to (5): the factors, row and offset of each degree of freedom, and y in w.dof. Afterwards w.IA, w.pA and d.coriolis are those of each body
/// with its joint eliminated, at its own origin. w.failed has, by lane, the first body whose pivot vanished, or 0.
template <class Order, class S, class T>
void articulatedInward(const Order& order, DerivativeWorkspace<S>& d, const S* tau, const Force<T>* fext) {
  Workspace<S>& w = order.w;
  for (int& body : w.failed) body = 0;
  const auto articulated = passing(d.coriolis, w.IA, w.pA);
  order.backward(articulated, [&]<class Joint>(const Joint&, int i, int iv, auto&& coriolis, auto&& inertia, auto&& force) {
    SubtreeMomentum<S>& own = d.subtree[i].m;
    writeMomentum<Joint>(order, w, i, own);
    const auto m = [&]() -> const SubtreeMomentum<S>& { return readAgain(order, own); };
    Force<S> pA = force.with(movingForce(w, i, m(), fext));
    ArticulatedInertia<S> IA = inertia.with(ArticulatedInertia<S>::rigid(m().mass, m().h, m().I));
    eliminateJoint<Joint>(order, w, IA, i, iv, [&](int k, const auto& column, const S& inverse, const Force<S>& row) {
      const S y = tau[iv + k] - column.along(pA);
      w.dof[iv + k].y = inverse * y;
      pA += y * row;
      d.factors.inverse[iv + k] = inverse;
      d.dof_force[iv + k].by_a = row;
    });
    if (needsRest<Joint>(order, i)) w.IA[i] = IA;
    // C follows after IA, because there are not enough registers for both.
    CoriolisMap<S> map = coriolis.with(coriolisMap(m().momentum.linear, turnedMoment(m(), w.w[i])));
    withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
      const int last = nvOf<Joint>(order, i) - 1;
#pragma GCC unroll 6
      for (int k = last; k >= 0; --k) {
        const Force<S>& row = d.dof_force[iv + k].by_a;
        const Vec3<S> torque = column(k).along(map.linear, map.angular);
        d.dof_force[iv + k].offset = d.factors.inverse[iv + k] * torque;
        map.linear = map.linear - outer(row.linear, torque);
        map.angular = map.angular - outer(row.angular, torque);
      }
    });
    const auto left = [&]() -> const ArticulatedInertia<S>& { return readAgain(order, w.IA[i]); };
    if (needsRest<Joint>(order, i)) {
      pA += left() * w.beta[i];
      w.pA[i] = pA;
    }
    if (order.isRoot(i)) return;
    d.coriolis[i] = map;
    if (order.hasOffset(i)) {
      const Vec3<S>& r = w.r[i];
      coriolis.giveInPlace([&](CoriolisMap<S>& to) { moveMap(readAgain(order, d.coriolis[i]), left, r, d.shift_rate[i], to); });
      inertia.giveInPlace([&](ArticulatedInertia<S>& to) { to = left().shifted(r); });
      addCross(pA.angular, r, pA.linear);
    } else {
      coriolis.give(readAgain(order, d.coriolis[i]));
      inertia.give(left());
    }
    force.give(pA);
  });
}

/// (8): the force that body i, with its joint eliminated, hands to its parent for each variation of the joint. f: the force through the joint.
template <class Joint, class Order, class S>
void writeHandedOver(const Order& order, const Workspace<S>& w, const DerivativeWorkspace<S>& d, int i, int iv, const Force<S>& f) {
  const ArticulatedInertia<S>& IA = w.IA[i];
  const CoriolisMap<S>& map = d.coriolis[i];
  const auto with = [&](const Force<S>& moved, [[maybe_unused]] const Vec3<S>& turning) {
    if constexpr (!Joint::has_angular) {
      return moved;
    } else {
      return Force<S>{moved.linear + map.linear * turning, moved.angular + map.angular * turning};
    }
  };
  for (int k = iv; k < iv + nvOf<Joint>(order, i); ++k) {
    const DofVariation<S>& x = d.dof[k];
    d.dof_force[k].by_q = with(IA * x.acceleration, x.velocity.angular) + turnedOf<Joint>(w.dof[k].column, f);
    d.dof_force[k].by_v = with(Column<Joint, S>{x.rate}.force(IA), w.dof[k].column.angular);
  }
}

/// (6) to (8): accelerations ddq, the variations of the degrees of freedom, and the forces that these hand over. Within a joint, degrees of freedom
/// are visited in the reverse order of elimination. For joints whose subspace varies, w.f gets the force through the joint.
template <class Order, class S>
void acceleratingOutward(const Order& order, DerivativeWorkspace<S>& d, const S* v, S* ddq) {
  Workspace<S>& w = order.w;
  order.forward(passing(w.acc), [&]<class Joint>(const Joint& joint, int i, int iv, auto&& accelerated) {
    const Motion<S> carried = carriedAcceleration<Joint>(order, i, accelerated.get(), order.gravity());
    Motion<S> acc = carried + w.beta[i];
    withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
      for (int k = 0; k < nvOf<Joint>(order, i); ++k) {
        const S x = w.dof[iv + k].y - dot(acc, d.dof_force[iv + k].by_a);
        ddq[iv + k] = x;
        column(k).addTo(acc, x);
      }
    });
    Vec3<S> slide{};
    if constexpr (Joint::has_linear) slide = joint.timesIn(w.R[i], v + iv).linear;
    writeVariations<Joint>(order, d, i, iv, order.parent(w.w, i), w.w[i], carried, slide, v, static_cast<const S*>(ddq));
    if (needsRest<Joint>(order, i)) {
      const Force<S> f = w.IA[i] * carried + w.pA[i];
      if constexpr (Joint::has_bias) w.f[i] = f;
      if (!order.isRoot(i)) writeHandedOver<Joint>(order, w, d, i, iv, f);
    }
    accelerated.leave(acc);
  });
}

/// Subtracts x from right_q(k, j), which articulatedSweep has entered.
template <class S>
void subtractRight(const CompactImpl& m, const DerivativeWorkspace<S>& d, int k, int j, const S& x) {
  if constexpr (in_pairs<S>) {
    d.projections[j].at(m.dof_depth[static_cast<std::size_t>(k)])[ColumnProjections<S>::by_q] -= d.factors.inverse[k] * x;
  } else {
    d.by_q.right[k][j] -= x;
  }
}
/// below_q(row, column) of two degrees of freedom of one joint.
template <class S>
S& ownLower(const CompactImpl& m, const DerivativeWorkspace<S>& d, int row, int column) {
  if constexpr (in_pairs<S>) {
    return d.pairs.at(m, PathPairs<S>::q_lower, row, column);
  } else {
    return d.by_q.below[column][row];
  }
}

/// (10) for subspaces that vary: adds the torques S . f to by_q. U gives their projections on the joints of the root path.
template <class R, class S>
void addSubspaceTorques(const R& recursion, const DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  const Rows<S> U = d.factors.U;
  order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
    const int nv = nvOf<Joint>(order, i);
    if constexpr (Joint::has_bias)
      for (int j = iv; j < iv + nv; ++j) {
        S torque[most_nv<Joint>];
        for (int l = 0; l < nv; ++l) torque[l] = numberOf(subspaceTorque<Joint>(order, recursion.d, order.w.f[i], i, j - iv, l));
        alongPath(order.m, iv + nv - 1, [&](int k) {
          S projection(0);
          for (int l = std::max(k - iv, 0); l < nv; ++l) projection += torque[l] * U[k][iv + l];
          if (k <= j) {
            subtractRight<S>(order.m, d, k, j, projection);
          } else {
            // The joint's own degrees of freedom after j: the product (11) does not reach them, so their part goes into below_q.
            projection *= d.factors.inverse[k];
            for (int other = k; other < order.dofEnd(i); ++other) ownLower<S>(order.m, d, other, j) += projection * U[k][other];
          }
        });
      }
  });
}
/// (1) to (10): accelerations ddq under the forces tau, and d.by_q, d.by_v and d.factors, from which (11) forms their derivatives, dissipation
/// included. w has the evaluated joints, d the derivatives of their subspaces. w.failed has, by lane, the first body whose pivot vanished, or 0.
template <class Wide, class R, class S>
void abaDerivativesSweep(const R& r, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* tau, S* ddq, const Force<S>* fext = nullptr) {
  movingOutward(r.order, r.d, r.in(v));
  articulatedInward(r.order, r.d, r.in(tau), fext);
  acceleratingOutward(r.order, r.d, r.in(v), r.out(ddq));
  articulatedSweep<Wide>(r, d);
  addSubspaceTorques(r, d);
  r.failures(w.failed);
}

/// After the sweep, (11): the derivative of ddq, n x n, from d.by_q or from d.by_v.
template <class Wide, class S>
void accelerationBy(const CompactImpl& m, const TreeFactors<S>& factors, const PathMatrix<S>& by, const Rows<S>& out) {
  downTheTree<Wide, false>(m, factors, by.right, FromMinus<S>{by.below}, out);
}
/// How many degrees of freedom on the path of column j, from the root on, have entries right(k, j). Those of j's own joint have them only for
/// damping and for a subspace that varies.
inline int countOfProjections(const CompactImpl& m, int j) {
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const BodyIndex& x = m.index[at(m.dof_body[at(j)])];
  const bool own = !m.damping.empty() || m.batches[at(x.batch)].shape == Shape::dense;
  return own ? m.dof_depth[at(j)] + 1 : m.dof_depth[at(x.idx_v)];
}
/// Subtracts below(i, c) from columns j to j + columns - 1, n numbers each: the entries below the diagonal and within each joint.
template <int columns, class S>
void subtractBelow(const CompactImpl& m, const PathPairs<S>& pairs, typename PathPairs<S>::Number below, int j, S* out) {
  using Pairs = PathPairs<S>;
  const std::ptrdiff_t n = m.nvx;
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const auto joint = [&](int dof) -> const BodyIndex& { return m.index[at(m.dof_body[at(dof)])]; };
  int end = m.dof_end[at(j)];
  if (joint(j).floating_base) {
    // Entries of other joints lie where DofForces says.
    static_assert(6 % columns_together<S> == 0, "its columns are not together with others");
    const bool by_q = below == Pairs::q_lower, plain = !m.roots_have_armature;
    const int others = joint(j).idx_v + 6, axis = j - joint(j).idx_v, first = by_q || plain ? std::max(3 - axis, 0) : 0;
    for (int row = others; row < end && !(by_q && plain); ++row) {
      const DofForces<S>& found = pairs.forces(row);
      for (int c = first; c < columns; ++c) {
        const int k = axis + c;
        out[c * n + row] -= by_q ? found.offset[k - 3] : (k < 3 ? found.by_a.linear : found.by_a.angular)[k % 3];
      }
    }
    end = others;
  }
  const int depth = m.dof_depth[at(j)];
  const auto found = [&](int row) { return pairs.row(row, depth) + below; };
  int row = joint(j).idx_v;
  for (int count = 0; row < joint(j + columns - 1).idx_v; ++row) {
    while (count < columns && joint(j + count).idx_v <= row) ++count;
    const S* const x = found(row);
    for (int c = 0; c < count; ++c) out[c * n + row] -= x[Pairs::numbers * c];
  }
  for (; row < end; ++row) {
    const S* const x = found(row);
#pragma GCC unroll 6
    for (int c = 0; c < columns; ++c) out[c * n + row] -= x[Pairs::numbers * c];
  }
}
/// (11) by q and by v for states in packs. Writes some columns at a time to `out`, n numbers each, and calls put(which, begin, count) for them.
/// by_q and by_v take turns, so that both use the same rows of U.
template <class S, class Put>
void accelerationsBy(const CompactImpl& m, const DerivativeWorkspace<S>& d, const ProductScratch<S>& scratch, S* out, Put&& put) {
  using Projections = ColumnProjections<S>;
  using Pairs = PathPairs<S>;
  inChains(m, d.factors, scratch, [&]<int columns>(const ChainProduct<S>& chain, int j) {
    const int length = countOfProjections(m, j + columns - 1);
    for (const auto product : {Projections::by_q, Projections::by_v}) {
      chain.template write<columns, Projections::products>(0, length, d.projections[j].at(0) + product, out, m.nvx);
      subtractBelow<columns>(m, d.pairs, product == Projections::by_q ? Pairs::q_lower : Pairs::v_lower, j, out);
      put(product, j, columns);
    }
  });
}

/// Where the derivatives of one state's accelerations are written, n x n each. by_tau is M^-1.
struct AccelerationDerivatives {
  double *by_q, *by_v, *by_tau;
};
/// ddq and its derivatives of one state, over bodies: over lane groups they measured no faster. Dissipation is already subtracted from tau; the
/// derivatives include it.
template <class Wide>
void abaDerivatives(const CompactImpl& m, Workspace<double>& w, DerivativeWorkspace<double>& d, const double* v, const double* tau,
                    const Force<double>* fext, double* ddq, const AccelerationDerivatives& out) {
  abaDerivativesSweep<Wide>(recursion(m, w, d), w, d, v, tau, ddq, fext);
  inverseOfMassMatrix<Wide>(m, d.factors, Rows<double>{out.by_tau, m.nvx});
  accelerationBy<Wide>(m, d.factors, d.by_q, Rows<double>{out.by_q, m.nvx});
  accelerationBy<Wide>(m, d.factors, d.by_v, Rows<double>{out.by_v, m.nvx});
}

}  // namespace dyn::kernels
