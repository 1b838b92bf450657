// Derivatives of inverse dynamics, in aligned frames.
//
// Moving along degree of freedom m turns its subtree rigidly with s_m and adds to the subtree's velocity and acceleration (Singh, Russell
// and Wensing 2022, "Efficient analytical derivatives of rigid-body dynamics using spatial vector algebra", psi-dot and psi-ddot there)
//   dv = v_p x s + E,   da = a_p x s + v_p x dv + v x E + A + H
// where p is the parent, and E, A, H, the terms of a subspace that varies with q, are not in that paper:
//   E = sum_l dS_l/dq_m v_l,   A = sum_l dS_l/dq_m a_l,   H = d((dS/dt) v)/dq_m.
// The Coriolis force that a turning rate w brings to the bodies of a subtree is 2 sum m [w x r'; r x (w x r')], r' their velocities: of
// these it takes the momentum and K = sum m r' r^T. Velocities are counted relative to each joint's origin, so the base's does not enter.
//
// Only poses, velocities and accelerations on the way out, and sums on the way in, go from body to body. The rest is computed of each for
// itself (variations.hpp): body by body where S is a pack, and otherwise of all bodies and degrees of freedom in packs once the sweep is done.
#pragma once

#include "kernels/variations.hpp"

namespace dyn::kernels {

template <class S, class Joint>
SubspaceTerms<S> subspaceTerms(const SubspaceDerivatives<S>& dS, int slot, int m, const Mat3<S>& R, const S* v, const S* a) {
  SubspaceTerms<S> x;
  if constexpr (Joint::has_bias) {
    x.acceleration = dS.biasRate(m, slot);
    for (int l = 0; l < Joint::nv; ++l) {
      const Motion<S> along = dS.column(Joint::nv, m, l, slot);
      x.velocity += v[l] * along;
      x.acceleration += a[l] * along;
      x.rate += v[l] * dS.column(Joint::nv, l, m, slot);
    }
    for (Motion<S>* term : {&x.velocity, &x.acceleration, &x.rate}) *term = {R * term->linear, R * term->angular};
  }
  return x;
}

/// Calls use(first, columns) for each pack of degrees of freedom, the last ones first.
template <class Wide, class Use>
void inDofsAbreast(const CompactImpl& m, Use&& use) {
  constexpr int width = lanes_of<Wide>;
  for (int group = static_cast<int>(m.dofs_abreast.size()) - 1; group >= 0; --group) {
    const DofsAbreast& has = m.dofs_abreast[static_cast<std::size_t>(group)];
    for (int lane = abreast<double> - width; lane >= 0; lane -= width) {
      const int first = abreast<double> * group + lane;
      if (has.varies) {
        use(first, ColumnParts<true, true>());
      } else if (has.turn_only) {
        use(first, ColumnParts<false, false>());
      } else {
        use(first, ColumnParts<true, false>());
      }
    }
  }
}

template <class Wide>
SubtreeMomentum<Wide> ownMomentum(const CompactImpl& m, const BodyMotion<Wide>& x, int i) {
  const BodyInertia<Wide> c = AoSoA<BodyInertia, double>(const_cast<double*>(m.inertias.data())).template get<Wide>(i);
  return ownMomentum<Wide>(c.mass, x.R * c.h, congruence(x.R, c.origin), x.w);
}
/// T<Wide> of neighbours from body i on, where T is a Subtree or its beginning.
template <template <class> class T, class Wide>
void scatterTo(const T<Wide>& x, DerivativeWorkspace<double>& d, int i) {
  constexpr int numbers = sizeof(x) / sizeof(Wide), stride = sizeof(Subtree<double>) / sizeof(double);
  scatterStructs<numbers>(reinterpret_cast<const Wide*>(&x), reinterpret_cast<double*>(d.subtree + i), stride);
}
template <class Wide>
__attribute__((noinline, flatten)) void ownMomenta(const CompactImpl& m, DerivativeWorkspace<double>& d) {
  for (int i = 0; i < m.bodies(); i += lanes_of<Wide>) scatterTo(ownMomentum<Wide>(m, d.body_motion.template get<Wide>(i), i), d, i);
}

/// Own momenta and forces of bodies whose motions have been left in d.body_motion, and variations of degrees of freedom from d.dof_motion.
template <class Wide>
__attribute__((noinline, flatten)) void ownMotions(const CompactImpl& m, DerivativeWorkspace<double>& d) {
  for (int i = 0; i < m.bodies(); i += lanes_of<Wide>) {
    const BodyMotion<Wide> x = d.body_motion.template get<Wide>(i);
    scatterTo(ownMotion(ownMomentum<Wide>(m, x, i), x.w, x.acceleration), d, i);
  }
  inDofsAbreast<Wide>(m, [&]<class ColumnParts>(int k, ColumnParts) {
    SubspaceTerms<Wide> more;
    if constexpr (ColumnParts::has_bias) more = d.terms.template get<Wide>(k);
    d.dof.template put<Wide>(k, variationOf<ColumnParts>(d.dof_motion.template get<Wide>(k), more));
  });
}

/// Placements, motions and forces of the bodies, and each degree of freedom's variation.
template <class Wide, class S, class Order>
void derivativesOutward(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d, const Vec3<S>& gravity, const S* v, const S* a,
                        const Force<S>* fext) {
  w.w[0] = {};
  order.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const auto& c = order.constants(i);
    placeAligned<S>(joint, order, c.placement, i, w);
    const Mat3<S>& R = w.R[i];
    const Vec3<S>& r = w.r[i];
    const Vec3<S>& wp = order.parent(w.w, i);
    Motion<S> ap = order.parent(w.acc, i);
    if (order.isRoot(i)) ap = {isFlyingRoot<Joint>(order, i) ? transposeTimes(w.rel[i].R, -gravity) : -gravity, {}};
    ap.linear += cross(ap.angular, r) + cross(wp, cross(wp, r));

    const Motion<S> s = joint.timesIn(R, v + iv);
    Motion<S> ds = joint.timesIn(R, a + iv);
    if constexpr (Joint::has_bias) {
      const Motion<S> b = joint.bias();
      ds += {R * b.linear, R * b.angular};
    }
    const Vec3<S> omega = turnedBy<Joint>(wp, s);
    Motion<S> acc = ap;
    if constexpr (Joint::has_angular) acc.angular += ds.angular + cross(wp, s.angular);
    if constexpr (Joint::has_linear) acc.linear += ds.linear + cross(wp + omega, s.linear);
    w.w[i] = omega;
    w.acc[i] = acc;
    Vec3<S> shift_rate = cross(wp, r);
    if constexpr (Joint::has_linear) shift_rate += s.linear;
    d.shift_rate[i] = shift_rate;

    if constexpr (abreast<S> > 1) {
      d.body_motion.put(i, {R, omega, acc});
    } else {
      const auto [h, I] = alignedInertia<S, Joint>(order, i, c, R);
      d.subtree[i] = ownMotion(ownMomentum(S(c.mass), h, I, omega), omega, acc);
    }
    for (int k = 0; k < Joint::nv; ++k) {
      const DofMotion<S> motion{joint.columnIn(R, k), wp, omega, ap, s.linear};
      w.dof[iv + k].S_ = motion.column;
      SubspaceTerms<S> more;
      if constexpr (Joint::has_bias) {
        const BodyIndex& x = order.index(i);
        more = subspaceTerms<S, Joint>(d.subspaces[x.batch], x.slot, k, R, v + iv, a + iv);
      }
      if constexpr (abreast<S> == 1) {
        d.dof.put(iv + k, variationOf<Joint>(motion, more));
      } else {
        d.dof_motion.put(iv + k, motion);
        if constexpr (Joint::has_bias) d.terms.put(iv + k, more);
      }
    }
  });
  if constexpr (abreast<S> > 1) ownMotions<Wide>(order.m, d);
  for (int i = 1; fext && i < order.m.bodies(); ++i) d.subtree[i].f -= Force<S>{w.R[i] * fext[i].linear, w.R[i] * fext[i].angular};
}

/// Forces of all degrees of freedom, whose subtrees are summed.
template <class Wide>
__attribute__((noinline, flatten)) void ownForces(const CompactImpl& m, DerivativeWorkspace<double>& d) {
  inDofsAbreast<Wide>(m, [&]<class ColumnParts>(int k, ColumnParts) {
    const double* from[lanes_of<Wide>];
    for (int l = 0; l < lanes_of<Wide>; ++l)
      from[l] = reinterpret_cast<const double*>(d.subtree + m.dof_body[static_cast<std::size_t>(std::min(k + l, m.nvx - 1))]);
    Subtree<Wide> c;
    gatherStructs<sizeof(c) / sizeof(Wide)>(from, reinterpret_cast<Wide*>(&c));
    const auto column = d.dof_motion.template part<Motion, Wide>(k, 0);
    d.force.template put<Wide>(k, forcesOf<ColumnParts>(column, d.dof.template get<Wide>(k), c));
  });
}

/// Composite quantities, and from them the forces that each degree of freedom's variations bring, about its joint's origin.
template <class Wide, class S, class Order>
void derivativesInward(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  order.backward([&]<class Joint>(const Joint&, int i, [[maybe_unused]] int iv) {
    const Subtree<S>& c = d.subtree[i];
    if constexpr (abreast<S> == 1)
      for (int k = iv; k < iv + Joint::nv; ++k) d.force.put(k, forcesOf<Joint>(w.dof[k].S_, d.dof[k], c));
    if (!order.isRoot(i)) addTo(d.subtree[order.parentOf(i)], c, w.r[i], d.shift_rate[i]);
  });
  if constexpr (abreast<S> > 1) ownForces<Wide>(order.m, d);
}

/// The columns of all subtrees on their way to the root, U, lever and forces in d.force: s . U into d.by_a; what U and lever say of the
/// variations of the joints that they reach below the diagonals of d.by_q and d.by_v; s . forces right of these.
template <class Wide, class S, class Order>
void pathSweep(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  using D = DofForces<Wide>;
  // Copies: what packs are stored into might be anything, even the struct that says where.
  const AoSoA<DofForces, S> force = d.force;
  const PathMatrix<S> by_a = d.by_a, by_q = d.by_q, by_v = d.by_v;
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    const Vec3<Wide> r = cast<Wide>(w.r[i]), rate = cast<Wide>(S(2) * d.shift_rate[i]);
    inParts<Wide, S>(iv, order.dofEnd(i), [&](const Part<Wide, S>& part) {
      const DofForces<Wide> F = force.template get<Wide>(part.first());
      const Force<Wide>& U = F.by_a;
      const Vec3<Wide>& lever = F.lever;
      const auto enter = [&](int k, const auto& column, const Wide& q, const Wide& v) {
        by_a.enterSymmetric(part, iv + k, column.along(U));
        by_q.enterBelow(part, iv + k, q);
        by_v.enterBelow(part, iv + k, v);
        by_q.enterRight(part, iv + k, iv + Joint::nv, column.along(F.by_q));
        by_v.enterRight(part, iv + k, iv + Joint::nv, column.along(F.by_v));
      };
      if constexpr (Joint::is_free) {
        // Nothing moves before a flying root: what it makes of its own columns has no more than these.
        if (order.isRoot(i)) {
          for (int k = 0; k < 3; ++k) {
            const DofVariation<S> slide = d.dof[iv + k], turn = d.dof[iv + 3 + k];
            const Vec3<Wide> by_turn = cast<Wide>(turn.rate.linear), turn_rate = cast<Wide>(turn.rate.angular);
            enter(k, UnitColumn<S>{k}, Wide(0), dot(cast<Wide>(slide.rate.linear), U.linear));
            enter(3 + k, UnitColumn<S>{3 + k}, dot(cast<Wide>(turn.acceleration.linear), U.linear),
                  dot(by_turn, U.linear) + dot(turn_rate, U.angular) + lever[k]);
          }
          return;
        }
      }
      for (int k = 0; k < Joint::nv; ++k) {
        const Column<Joint, S> column{w.dof[iv + k].S_};
        const DofVariation<S> x = d.dof[iv + k];
        Wide q = dot(cast<Wide>(x.acceleration.linear), U.linear) + dot(cast<Wide>(x.acceleration.angular), U.angular),
             v = dot(cast<Wide>(x.rate.angular), U.angular);
        if constexpr (Joint::has_linear) v += dot(cast<Wide>(x.rate.linear), U.linear);
        if constexpr (Joint::has_angular) {
          q += dot(cast<Wide>(x.velocity.angular), lever);
          v += dot(cast<Wide>(column.s.angular), lever);
        }
        enter(k, column, q, v);
      }
      if (order.isRoot(i)) return;
      const Vec3<Wide> here = part.inside() * r;
      const int first = part.first();
      force.putPart(first, D::at_by_a + D::angular, U.angular + cross(here, U.linear));
      force.putPart(first, D::at_lever, lever + cross(part.inside() * rate, U.linear));
      force.putPart(first, D::at_by_q + D::angular, F.by_q.angular + cross(here, F.by_q.linear));
      force.putPart(first, D::at_by_v + D::angular, F.by_v.angular + cross(here, F.by_v.linear));
    });
  });
}

/// d.by_q, d.by_v and d.by_a, which are the derivatives of rnea, losses included.
template <class Wide, class S, class Order>
void derivativesSweep(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  pathSweep<Wide>(order, w, d);
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    // Within a joint nothing turns: all entries are of the kind that stands below the diagonal.
    for (int m = 0; m < Joint::nv; ++m)
      for (int k = 0; k < Joint::nv; ++k) {
        S entry = d.by_q.below[iv + m][iv + k];
        if constexpr (Joint::has_bias) {
          const BodyIndex& x = order.index(i);
          const Motion<S> dS = d.subspaces[x.batch].column(Joint::nv, m, k, x.slot);
          entry += dot(Motion<S>{w.R[i] * dS.linear, w.R[i] * dS.angular}, d.subtree[i].f);
        }
        d.by_q.enterOwn(iv + k, iv + m, entry);
        d.by_v.enterOwn(iv + k, iv + m, d.by_v.below[iv + m][iv + k]);
      }
    for (int k = 0; k < Joint::nv; ++k) d.by_a.below[iv + k][iv + k] += order.armature(iv + k);
  });
  const CompactImpl& m = order.m;
  for (std::size_t k = 0; k < m.damping.size(); ++k) d.by_v.below[static_cast<int>(k)][k] += S(static_cast<Real<S>>(m.damping[k]));
}

}  // namespace dyn::kernels
