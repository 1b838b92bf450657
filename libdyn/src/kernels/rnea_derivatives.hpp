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

#include "kernels/crba.hpp"
#include "kernels/derivatives.hpp"

namespace dyn::kernels {

/// Force [N, N m] about the joint's origin that a turning rate x brings to a subtree: Coriolis.
template <class S>
Force<S> coriolis(const SubtreeMotion<S>& c, const Vec3<S>& x) {
  const S trace = c.K(0, 0) + c.K(1, 1) + c.K(2, 2);
  return S(2) * Force<S>{cross(x, c.momentum.linear), trace * x - c.K * x};
}
/// The turning rates' lever on a motion s: coriolis(x) . s = lever . x.
template <class Joint, class S>
Vec3<S> coriolisLever(const SubtreeMotion<S>& c, const Motion<S>& s) {
  const S trace = c.K(0, 0) + c.K(1, 1) + c.K(2, 2);
  Vec3<S> lever{};
  if constexpr (Joint::has_angular) lever = trace * s.angular - transposeTimes(c.K, s.angular);
  if constexpr (Joint::has_linear) lever += cross(c.momentum.linear, s.linear);
  return S(2) * lever;
}
/// A subtree's momentum about the parent's origin, with velocities relative to it.
template <class S>
Force<S> momentumInParent(const SubtreeMotion<S>& c, const S& mass, const Vec3<S>& h, const Vec3<S>& r) {
  const Vec3<S> linear = c.momentum.linear + mass * c.shift_rate;
  return {linear, c.momentum.angular + cross(h, c.shift_rate) + cross(r, linear)};
}
template <class S>
Force<S> rigidForce(const S& mass, const Vec3<S>& h, const Sym3<S>& I, const Motion<S>& x) {
  return {mass * x.linear + cross(x.angular, h), cross(h, x.linear) + I * x.angular};
}

/// Of motions with the parts that a joint's shape has.
template <class Joint, class S>
Force<S> rigidForceOf(const S& mass, const Vec3<S>& h, const Sym3<S>& I, const Motion<S>& x) {
  if constexpr (!Joint::has_linear) {
    return {cross(x.angular, h), I * x.angular};
  } else {
    return rigidForce(mass, h, I, x);
  }
}

/// s x* f: how a force that is fixed to a body changes when the body turns with s (Featherstone 2008, eq. 2.32).
template <class S>
Force<S> turned(const Motion<S>& s, const Force<S>& f) {
  return {cross(s.angular, f.linear), cross(s.angular, f.angular) + cross(s.linear, f.linear)};
}
template <class Joint, class S>
Force<S> turnedOf(const Motion<S>& s, const Force<S>& f) {
  if constexpr (!Joint::has_linear) {
    return {cross(s.angular, f.linear), cross(s.angular, f.angular)};
  } else {
    return turned(s, f);
  }
}

/// What a joint of varying subspace adds, in aligned axes; zero for the others.
template <class S>
struct SubspaceTerms {
  Motion<S> velocity, acceleration, rate;  ///< E; A + H; sum_n dS_m/dq_n v_n
};
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

/// Placements, motions and forces of the bodies, and each degree of freedom's variation.
template <class S, class Order>
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
    const Vec3<S>& slide = s.linear;
    const Vec3<S> omega = turnedBy<Joint>(wp, s);
    Motion<S> acc = ap;
    if constexpr (Joint::has_angular) {
      acc.angular += ds.angular + cross(wp, s.angular);
    }
    if constexpr (Joint::has_linear) acc.linear += ds.linear + cross(wp + omega, slide);
    w.w[i] = omega;
    w.acc[i] = acc;

    const auto [h, I] = alignedInertia<S, Joint>(order, i, c, R);
    w.mass[i] = c.mass;
    w.h[i] = h;
    w.Io[i] = I;
    const S half = S(0.5) * (I.xx + I.yy + I.zz);
    // Sum of mass * position * position^T, whose columns the body turns.
    const Mat3<S> second{{half - I.xx, -I.xy, -I.xz, -I.xy, half - I.yy, -I.yz, -I.xz, -I.yz, half - I.zz}};
    const Vec3<S> k0 = cross(omega, second.col(0)), k1 = cross(omega, second.col(1)), k2 = cross(omega, second.col(2));
    Vec3<S> shift_rate = cross(wp, r);
    if constexpr (Joint::has_linear) shift_rate += slide;
    const Vec3<S> momentum = cross(omega, h), spin = I * omega;
    d.body[i] = {shift_rate, {momentum, spin}, {{k0.x, k1.x, k2.x, k0.y, k1.y, k2.y, k0.z, k1.z, k2.z}}};
    const Force<S> inertial = rigidForce(S(c.mass), h, I, acc);
    w.f[i] = {inertial.linear + cross(omega, momentum), inertial.angular + cross(omega, spin)};
    if (fext) w.f[i] -= Force<S>{R * fext[i].linear, R * fext[i].angular};

    const BodyIndex& x = order.index(i);
    Vec3<S> al = ap.linear;
    if constexpr (Joint::has_linear) al += cross(wp, slide);
    for (int k = 0; k < Joint::nv; ++k) {
      const Motion<S> column = joint.columnIn(R, k);
      w.dof[iv + k].S_ = column;
      const Vec3<S>&sl = column.linear, &sw = column.angular;
      Motion<S> velocity, acceleration{cross(al, sw), cross(ap.angular, sw)}, rate{{}, cross(omega, sw)};
      velocity.angular = cross(wp, sw);
      if constexpr (Joint::has_linear) {
        velocity.linear = cross(wp, sl) - cross(slide, sw);
        acceleration.linear += cross(ap.angular, sl);
        rate.linear = cross(omega, sl);
      }
      if constexpr (Joint::has_bias) {
        const SubspaceTerms<S> more = subspaceTerms<S, Joint>(d.subspaces[x.batch], x.slot, k, R, v + iv, a + iv);
        velocity += more.velocity;
        rate += more.rate;
        acceleration += more.acceleration + Motion<S>{cross(omega, more.velocity.linear), cross(omega, more.velocity.angular)};
      }
      if constexpr (Joint::has_linear) acceleration.linear += cross(wp, velocity.linear) - cross(slide, velocity.angular);
      acceleration.angular += cross(wp, velocity.angular);
      d.dof[iv + k] = {velocity, acceleration, velocity + rate};
    }
  });
}

/// Composite quantities, and from them the forces that each degree of freedom's variations bring, about its joint's origin.
template <class S, class Order>
void derivativesInward(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  using D = DerivativeWorkspace<S>;
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    const S mass = w.mass[i];
    const Vec3<S> h = w.h[i];
    const Sym3<S> I = w.Io[i];
    const SubtreeMotion<S> c = d.body[i];
    const Force<S> f = w.f[i];
    for (int k = 0; k < Joint::nv; ++k) {
      const Motion<S>& s = w.dof[iv + k].S_;
      const DofVariation<S>& x = d.dof[iv + k];
      writeForce(rigidForceOf<Joint>(mass, h, I, s), d.force, iv + k);
      writeVector(coriolisLever<Joint>(c, s), Rows<S>{d.force[D::lever], d.force.stride}, iv + k);
      writeForce(rigidForce(mass, h, I, x.acceleration) + coriolis(c, x.velocity.angular) + turnedOf<Joint>(s, f),
                 Rows<S>{d.force[D::force_by_q], d.force.stride}, iv + k);
      writeForce(rigidForceOf<Joint>(mass, h, I, x.rate) + coriolis(c, s.angular), Rows<S>{d.force[D::force_by_v], d.force.stride}, iv + k);
    }
    if (order.isRoot(i)) return;
    const Vec3<S>& r = w.r[i];
    const Vec3<S> moment = h + mass * r;
    order.addToParent(w.Io, i, shiftedInertia(I, mass, h, r));
    order.addToParent(w.h, i, moment);
    order.addToParent(w.mass, i, mass);
    order.addToParent(w.f, i, Force<S>{f.linear, f.angular + cross(r, f.linear)});
    SubtreeMotion<S>& parent = d.body[order.parentOf(i)];
    parent.momentum += momentumInParent(c, mass, h, r);
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        parent.K(row, column) += c.K(row, column) + c.momentum.linear[row] * r[column] + c.shift_rate[row] * moment[column];
  });
}

/// The columns of all subtrees on their way to the root, U, lever and forces in d.force: s . U into d.by_a; what U and lever say of the
/// variations of the joints that they reach below the diagonals of d.by_q and d.by_v; s . forces right of these.
template <class Wide, class S, class Order>
void pathSweep(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  using D = DerivativeWorkspace<S>;
  const Rows<S> levers{d.force[D::lever], d.force.stride}, by_q{d.force[D::force_by_q], d.force.stride}, by_v{d.force[D::force_by_v], d.force.stride};
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    const Vec3<Wide> r = broadcast<Wide>(w.r[i]), rate = broadcast<Wide>(S(2) * d.body[i].shift_rate);
    inParts<Wide, S>(iv, order.dofEnd(i), [&](const Part<Wide, S>& part) {
      const Force<Wide> U = loadForce(part, d.force), Fq = loadForce(part, by_q), Fv = loadForce(part, by_v);
      const Vec3<Wide> lever = loadVector(part, levers);
      const auto enter = [&](int k, const auto& column, const Wide& q, const Wide& v) {
        d.by_a.enterSymmetric(part, iv + k, column.along(U));
        d.by_q.enterBelow(part, iv + k, q);
        d.by_v.enterBelow(part, iv + k, v);
        d.by_q.enterRight(part, iv + k, iv + Joint::nv, column.along(Fq));
        d.by_v.enterRight(part, iv + k, iv + Joint::nv, column.along(Fv));
      };
      if constexpr (Joint::is_free) {
        // Nothing moves before a flying root: what it makes of its own columns has no more than these.
        if (order.isRoot(i)) {
          for (int k = 0; k < 3; ++k) {
            const DofVariation<S>&slide = d.dof[iv + k], &turn = d.dof[iv + 3 + k];
            const Vec3<Wide> by_turn = broadcast<Wide>(turn.rate.linear), turn_rate = broadcast<Wide>(turn.rate.angular);
            enter(k, UnitColumn<S>{k}, Wide(0), dot(broadcast<Wide>(slide.rate.linear), U.linear));
            enter(3 + k, UnitColumn<S>{3 + k}, dot(broadcast<Wide>(turn.acceleration.linear), U.linear),
                  dot(by_turn, U.linear) + dot(turn_rate, U.angular) + lever[k]);
          }
          return;
        }
      }
      for (int k = 0; k < Joint::nv; ++k) {
        const Column<Joint, S> column{w.dof[iv + k].S_};
        const DofVariation<S>& x = d.dof[iv + k];
        Wide q = dot(broadcast<Wide>(x.acceleration), U), v = dot(broadcast<Wide>(x.rate.angular), U.angular);
        if constexpr (Joint::has_linear) v += dot(broadcast<Wide>(x.rate.linear), U.linear);
        if constexpr (Joint::has_angular) {
          q += dot(broadcast<Wide>(x.velocity.angular), lever);
          v += dot(broadcast<Wide>(column.s.angular), lever);
        }
        enter(k, column, q, v);
      }
      if (order.isRoot(i)) return;
      const Wide inside = part.inside();
      const Vec3<Wide> here = inside * r;
      storeVector(part, U.angular + cross(here, U.linear), d.force, 3);
      storeVector(part, lever + cross(inside * rate, U.linear), levers);
      storeVector(part, Fq.angular + cross(here, Fq.linear), by_q, 3);
      storeVector(part, Fv.angular + cross(here, Fv.linear), by_v, 3);
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
          entry += dot(Motion<S>{w.R[i] * dS.linear, w.R[i] * dS.angular}, w.f[i]);
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
