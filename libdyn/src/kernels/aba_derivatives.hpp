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

/// Factors of the elimination, the columns' beginnings, and what of the accelerations the forces tau and the velocities say, into w.dof's y; then
/// w.IA, w.pA and d.coriolis have what each body, its joint free to move, is to its parent. w.failed tells lane by lane whether a pivot vanished.
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
    // After IA: there are not enough registers for both.
    CoriolisMap<S> map = coriolis.with(coriolisMap(m().momentum.linear, turnedMoment(m(), w.w[i])));
    withColumns<Joint>(order, w, i, iv, [&](const auto& column) {
      const int last = nvOf<Joint>(order, i) - 1;
#pragma GCC unroll 6
      for (int k = last; k >= 0; --k) {
        const Force<S>& row = d.dof_force[iv + k].by_a;
        const Vec3<S> torque = column(k).along(map.linear, map.angular);
        d.dof_force[iv + k].lever = d.factors.inverse[iv + k] * torque;
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
    if (order.hasLever(i)) {
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

/// What body i, its joint free to move, hands to its parent of each variation of the joint, the force f through it being turned, too.
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
    d.dof_force[k].by_q = with(IA * x.acceleration, x.velocity.angular) + turnedOf<Joint>(w.dof[k].S_, f);
    d.dof_force[k].by_v = with(Column<Joint, S>{x.rate}.force(IA), w.dof[k].S_.angular);
  }
}

/// Accelerations ddq, and with them the degrees of freedom's variations, and what these hand over; of subspaces that vary the force through the
/// joint, into w.f. Within a joint in the reverse order of elimination.
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

/// Subtracts from what articulatedSweep has entered into by_q, right of the diagonal, of degree of freedom k and j of its subtree.
template <class S>
void subtractRight(const CompactImpl& m, const DerivativeWorkspace<S>& d, int k, int j, const S& x) {
  if constexpr (in_pairs<S>) {
    d.shares[j].at(m.dof_depth[static_cast<std::size_t>(k)])[ColumnShares<S>::by_q] -= d.factors.inverse[k] * x;
  } else {
    d.by_q.right[k][j] -= x;
  }
}
/// The entry of by_q below the diagonal of two of one joint's.
template <class S>
S& ownBelow(const CompactImpl& m, const DerivativeWorkspace<S>& d, int row, int column) {
  if constexpr (in_pairs<S>) {
    return d.pairs.at(m, PathPairs<S>::q_below, row, column);
  } else {
    return d.by_q.below[column][row];
  }
}

/// To by_q: the torques s . f of subspaces that vary. Joints on the way to the root get of them what U says.
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
          S share(0);
          for (int l = std::max(k - iv, 0); l < nv; ++l) share += torque[l] * U[k][iv + l];
          if (k <= j) {
            subtractRight<S>(order.m, d, k, j, share);
          } else {
            // The joint's own after j, which products of factors take from their beginnings.
            share *= d.factors.inverse[k];
            for (int other = k; other < order.dofEnd(i); ++other) ownBelow<S>(order.m, d, other, j) += share * U[k][other];
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
  articulatedSweep<Wide>(r, d);
  addSubspaceTorques(r, d);
  r.failures(w.failed);
}

/// After the sweep: the derivative that one of d.by_q and d.by_v is made into, n x n.
template <class Wide, class S>
void accelerationBy(const CompactImpl& m, const TreeFactors<S>& factors, const PathMatrix<S>& by, const Rows<S>& out) {
  downTheTree<Wide, false>(m, factors, by.right, FromMinus<S>{by.below}, out);
}
/// Of the degrees of freedom on the path of column j, from the root on: those that take shares of derivatives. Its own joint's do so only of what
/// damping and subspaces that vary say.
inline int countOfShares(const CompactImpl& m, int j) {
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const BodyIndex& x = m.index[at(m.dof_body[at(j)])];
  const bool own = !m.damping.empty() || m.batches[at(x.batch)].shape == Shape::dense;
  return own ? m.dof_depth[at(j)] + 1 : m.dof_depth[at(x.idx_v)];
}
/// From columns j and the next ones, n numbers each, what articulatedSweep has found below the diagonal, and of each whole joint.
template <int columns, class S>
void subtractBelow(const CompactImpl& m, const PathPairs<S>& pairs, typename PathPairs<S>::Number below, int j, S* out) {
  using Pairs = PathPairs<S>;
  const std::ptrdiff_t n = m.nvx;
  const auto at = [](int k) { return static_cast<std::size_t>(k); };
  const auto joint = [&](int dof) -> const BodyIndex& { return m.index[at(m.dof_body[at(dof)])]; };
  int end = m.dof_end[at(j)];
  if (joint(j).flying_root) {
    // Of others, as DofForces says.
    static_assert(6 % columns_abreast<S> == 0, "its columns are not together with others");
    const bool by_q = below == Pairs::q_below, bare = !m.roots_have_armature;
    const int others = joint(j).idx_v + 6, axis = j - joint(j).idx_v, first = by_q || bare ? std::max(3 - axis, 0) : 0;
    for (int row = others; row < end && !(by_q && bare); ++row) {
      const DofForces<S>& found = pairs.forces(row);
      for (int c = first; c < columns; ++c) {
        const int k = axis + c;
        out[c * n + row] -= by_q ? found.lever[k - 3] : (k < 3 ? found.by_a.linear : found.by_a.angular)[k % 3];
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
/// Both of states in packs, some columns at a time into `out`, n numbers each: put(which, begin, count) is called for these, by q and by v in turn,
/// so that the same rows of U go with them.
template <class S, class Put>
void accelerationsBy(const CompactImpl& m, const DerivativeWorkspace<S>& d, const ProductScratch<S>& scratch, S* out, Put&& put) {
  using Shares = ColumnShares<S>;
  using Pairs = PathPairs<S>;
  inChains(m, d.factors, scratch, [&]<int columns>(const ChainProduct<S>& chain, int j) {
    const int length = countOfShares(m, j + columns - 1);
    for (const auto product : {Shares::by_q, Shares::by_v}) {
      chain.template write<columns, Shares::products>(0, length, d.shares[j].at(0) + product, out, m.nvx);
      subtractBelow<columns>(m, d.pairs, product == Shares::by_q ? Pairs::q_below : Pairs::v_below, j, out);
      put(product, j, columns);
    }
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
