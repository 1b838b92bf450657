// Momentum about the centre of mass, its map and its derivatives, from what the derivatives of inverse dynamics have of each subtree.
//
// Everything is summed in aligned frames about the joints' own origins, in inertial frames that move with them, and moved to the centre of
// mass last: by y, from the joint's origin to the centre, and its rate. No position in the world enters.
#pragma once

#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// What momentum and its map take, and no more: placements and composite inertias; of a tree's root, momentum relative to its joint's origin, to
/// which each joint gives its column of the map.
template <class S, class Order>
void momenta(const Order& bodies, DerivativeWorkspace<S>& d, const S* v) {
  Workspace<S>& w = bodies.w;
  bodies.forward(passing(w.R, w.product), [&]<class Joint>(const Joint& joint, int i, int iv, auto&&... axes) {
    const Mat3<S> R = placeAligned<S>(joint, bodies, bodies.constants(i).placement, i, w, axes...);
    writeColumns(joint, R, w.dof + iv);
    // Where a root's origin goes all of the tree goes, which gives its centre no angular momentum.
    if (bodies.isRoot(i)) d.shift_rate[i] = joint.timesIn(R, v + iv).linear;
  });
  bodies.backward(passing(d.momentum), [&]<class Joint>(const Joint&, int i, int iv, auto&& handed) {
    const auto [mass, h, I] = alignedInertia<Joint>(bodies, w, i);
    SubtreeMomentum<S> m = handed.with({mass, h, I, {}});
    Force<S> momentum = m.momentum;
    for (int k = iv; k < iv + Joint::nv; ++k) {
      const Motion<S>& s = w.dof[k].S_;
      const Force<S> U = rigidForceOf<Joint>(m, s);
      d.dof_force[k].by_a = U;
      if (!bodies.isRoot(i)) {
        momentum += v[k] * U;
      } else if constexpr (Joint::has_angular) {
        momentum += v[k] * Force<S>{cross(s.angular, m.h), m.I * s.angular};
      }
    }
    m.momentum = momentum;
    d.subtree[i].m = m;
    if (bodies.isRoot(i)) return;
    SubtreeMomentum<S> given = movedInertia(m, w.r[i]);
    given.momentum = {momentum.linear, momentum.angular + cross(w.r[i], momentum.linear)};
    handed.give(given);
  });
}

/// Three numbers to where there is room for a fourth: what follows them may be overwritten.
template <class S>
void putVector(const Vec3<S>& x, S* to) {
  for (int k = 0; k < 3; ++k) to[k] = x[k];
}
inline void putVector(const Vec3<Vectored>& x, Vectored* to) { *reinterpret_cast<Square<double, 4>::Unaligned*>(to) = x.a; }

/// After momenta; or, for more than Ag and momentum, after derivativesOutward without gravity and derivativesInward. The trees that stand on the
/// world are one system: where there are several, their places in the world are compared.
template <class S, class Order>
CentroidalState<S> centroidalOf(const Order& bodies, DerivativeWorkspace<S>& d, const CentroidalMaps<S> out) {
  const Workspace<S>& w = bodies.w;
  // Copies: what vectors are stored into might be anything, even what says where.
  const int count = bodies.m.bodies();
  const BodyIndex* const index = bodies.m.index.data();
  Motion<S>* const places = d.place;  // y and its rate, aligned axes
  const Vec3<S>* const rs = w.r;
  const Subtree<S>* const subtrees = d.subtree;
  const DofFactor<S>* const dofs = w.dof;
  const DofForces<S>* const dof_forces = d.dof_force;
  // The first root is where the others are seen from.
  const int first = 1;
  const auto axesOf = [&](int root) { return bodies.index(root).flying_root ? w.rel[root].R : Mat3<S>::identity(); };
  const auto originOf = [&](int root) { return bodies.index(root).flying_root ? w.rel[root].p : w.r[root]; };
  const auto speedOf = [&](int root) { return axesOf(root) * d.shift_rate[root]; };
  S mass(0);
  Vec3<S> moment, flow;  // of mass, and of momentum, about the first root's origin and relative to its speed; world axes
  for (int root = first; root < count; root = bodies.treeEnd(root)) {
    const Mat3<S> R = axesOf(root);
    const SubtreeMomentum<S>& c = d.subtree[root].m;
    mass += c.mass;
    moment += R * c.h;
    flow += R * c.momentum.linear;
    if (root == first) continue;
    moment += c.mass * (originOf(root) - originOf(first));
    flow += c.mass * (speedOf(root) - speedOf(first));
  }
  const Vec3<S> centre = (S(1) / mass) * moment, drift = (S(1) / mass) * flow;

  CentroidalState<S> sum{};
  sum.mass = mass;
  for (int root = first; root < count; root = bodies.treeEnd(root)) {
    const Mat3<S> R = axesOf(root);
    const Vec3<S> apart = root == first ? Vec3<S>{} : originOf(root) - originOf(first),
                  parting = root == first ? Vec3<S>{} : speedOf(root) - speedOf(first);
    const Motion<S> place{transposeTimes(R, centre - apart), transposeTimes(R, drift - parting)};
    places[root] = place;
    const SubtreeMomentum<S>& c = subtrees[root].m;
    const auto about = [&](const Force<S>& f) { return Force<S>{R * f.linear, R * (f.angular - cross(place.linear, f.linear))}; };
    // Relative to the centre's own speed the whole has no linear momentum: that of the world is added at the end.
    const Vec3<S> linear = c.momentum.linear - c.mass * place.angular;
    sum.momentum += about({linear, c.momentum.angular - cross(c.h, place.angular)});
    if (out.rates) sum.rate += about(subtrees[root].f);
    sum.inertia += congruence(R, shiftedInertia(c.I, c.mass, c.h, -place.linear));
  }
  sum.momentum.linear = mass * (speedOf(first) + drift);

  // From each root to its leaves: where joints' origins are, seen from the centre of mass, and how fast they leave it.
  Mat3<S> R;
  Vec3<S> total_force;
  for (int i = 1; i < count; ++i) {
    const BodyIndex& x = index[i];
    Motion<S>& place = places[i];
    if (x.parent == 0) {
      R = axesOf(i);
      if (out.rates) total_force = (S(1) / mass) * transposeTimes(R, sum.rate.linear);
    } else {
      place.linear = places[x.parent].linear - rs[i];
      if (out.rates) place.angular = places[x.parent].angular - d.shift_rate[i];
    }
    const Vec3<S>&y = place.linear, &dy = place.angular;
    const SubtreeMomentum<S>& c = subtrees[i].m;
    const Mat3<S>& K = subtrees[i].K;
    for (int k = x.idx_v; k < x.idx_v + x.nv; ++k) {
      const Motion<S>& s = dofs[k].S_;
      const DofVariation<S>& change = d.dof[k];
      const DofForces<S>& forces = dof_forces[k];
      const auto write = [&](S* to, const Force<S>& f) {
        putVector(R * f.linear, to + 6 * k);
        putVector(R * (f.angular - cross(y, f.linear)), to + 6 * k + 3);
      };
      const Force<S>& U = forces.by_a;
      if (out.Ag) write(out.Ag, U);
      const auto inertiaTimes = [&](const Motion<S>& b) { return rigidForce(c, b); };
      if (out.dAg) {
        // d(I s)/dt = I ds/dt + (v x* I - I v x) s, of which coriolis() is the second part plus s x* (momentum).
        const Motion<S> ds = change.rate - change.velocity;
        const Force<S> rate = inertiaTimes(ds) + coriolis(c, K, s.angular) - turned(s, c.momentum);
        write(out.dAg, {rate.linear, rate.angular - cross(dy, U.linear)});
      }
      if (out.dh_dq) {
        const Force<S> change_of_momentum = turned(s, c.momentum) + inertiaTimes(change.velocity);
        write(out.dh_dq, {change_of_momentum.linear, change_of_momentum.angular + cross(dy, U.linear)});
      }
      if (out.dhdot_dq) {
        const Force<S>& by_q = forces.by_q;
        write(out.dhdot_dq, {by_q.linear, by_q.angular - cross(U.linear, total_force)});
      }
      if (out.dhdot_dv) write(out.dhdot_dv, forces.by_v);
    }
  }
  return sum;
}

/// Joints have been asked into w and, for more than Ag and momentum, how subspaces vary into d.
template <class S>
CentroidalState<S> centroidal(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* a,
                              const CentroidalMaps<S>& out) {
  const auto r = recursion(m, w, d);
  using T = typename decltype(r)::Scalar;
  if (out.rates) {
    derivativesOutward(r.order, r.d, Vec3<T>{}, r.in(v), r.in(a));
    derivativesInward(r.order, r.d);
  } else {
    momenta(r.order, r.d, r.in(v));
  }
  const auto to = [](S* numbers) { return reinterpret_cast<T*>(numbers); };
  const CentroidalState<T> sum = centroidalOf(r.order, r.d, {to(out.Ag), to(out.dAg), to(out.dh_dq), to(out.dhdot_dq), to(out.dhdot_dv), out.rates});
  const auto numbers = [](const Force<T>& f) { return Force<S>{cast<S>(f.linear), cast<S>(f.angular)}; };
  return {numbers(sum.momentum), numbers(sum.rate), cast<S>(sum.inertia), numberOf(sum.mass)};
}

}  // namespace dyn::kernels
