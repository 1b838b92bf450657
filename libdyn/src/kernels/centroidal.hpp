// Momentum about the centre of mass, its map and its derivatives, from what the derivatives of inverse dynamics have of each subtree.
//
// Everything is summed in aligned frames about the joints' own origins, in inertial frames that move with them, and moved to the centre of
// mass last: by y, from the joint's origin to the centre, and its rate. No position in the world enters.
#pragma once

#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// What momentum and its map take, and no more: placements, velocities and composite inertias and momenta.
template <class S, class Order>
void momenta(const Order& bodies, DerivativeWorkspace<S>& d, const S* v) {
  Workspace<S>& w = bodies.w;
  w.w[0] = {};
  bodies.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const auto [s, omega] = moveAligned<S>(joint, bodies, i, d, v + iv);
    d.subtree[i].m = bodyMomentum<Joint>(bodies, i, omega);
    writeColumns(joint, w.R[i], w.dof + iv);
  });
  bodies.backward([&]<class Joint>(const Joint&, int i, int iv) {
    const SubtreeMomentum<S>& m = d.subtree[i].m;
    for (int k = 0; k < Joint::nv; ++k) d.dof_force[iv + k].by_a = rigidForceOf<Joint>(m, w.dof[iv + k].S_);
    if (!bodies.isRoot(i)) addTo(d.subtree[bodies.parentOf(i)].m, m, w.r[i], d.shift_rate[i]);
  });
}

/// After momenta; or, for more than Ag and momentum, after derivativesOutward without gravity and derivativesInward. The trees that stand on the
/// world are one system: where there are several, their places in the world are compared.
template <class S, class Order>
CentroidalState<S> centroidalOf(const Order& bodies, DerivativeWorkspace<S>& d, const CentroidalMaps<S>& out) {
  const Workspace<S>& w = bodies.w;
  const CompactImpl& m = bodies.m;
  // The first root is where the others are seen from.
  const int first = 1;
  const auto axesOf = [&](int root) { return bodies.index(root).flying_root ? w.rel[root].R : Mat3<S>::identity(); };
  const auto originOf = [&](int root) { return bodies.index(root).flying_root ? w.rel[root].p : w.r[root]; };
  const auto speedOf = [&](int root) { return axesOf(root) * d.shift_rate[root]; };
  S mass(0);
  Vec3<S> moment, flow;  // of mass, and of momentum, about the first root's origin and relative to its speed; world axes
  for (int root = first; root < m.bodies(); root = bodies.treeEnd(root)) {
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
  // From each root to its leaves: where joints' origins are, seen from the centre of mass, and how fast they leave it.
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = bodies.index(i);
    Motion<S>& place = d.place[i];  // y and its rate, aligned axes
    if (x.parent == 0) {
      const Mat3<S> R = axesOf(i);
      const Vec3<S> apart = i == first ? Vec3<S>{} : originOf(i) - originOf(first), parting = i == first ? Vec3<S>{} : speedOf(i) - speedOf(first);
      place = {transposeTimes(R, centre - apart), transposeTimes(R, drift - parting)};
      const SubtreeMomentum<S>& c = d.subtree[i].m;
      const auto about = [&](const Force<S>& f) { return Force<S>{R * f.linear, R * (f.angular - cross(place.linear, f.linear))}; };
      // Relative to the centre's own speed the whole has no linear momentum: that of the world is added at the end.
      const Vec3<S> linear = c.momentum.linear - c.mass * place.angular;
      sum.momentum += about({linear, c.momentum.angular - cross(c.h, place.angular)});
      if (out.rates) sum.rate += about(d.subtree[i].f);
      sum.inertia += congruence(R, shiftedInertia(c.I, c.mass, c.h, -place.linear));
    } else {
      place = {d.place[x.parent].linear - w.r[i], d.place[x.parent].angular - d.shift_rate[i]};
    }
  }
  sum.momentum.linear = mass * (speedOf(first) + drift);

  int root = first;
  for (int i = 1; i < m.bodies(); ++i) {
    const BodyIndex& x = bodies.index(i);
    if (x.parent == 0) root = i;
    const Mat3<S> R = axesOf(root);
    const Vec3<S>&y = d.place[i].linear, &dy = d.place[i].angular;
    const SubtreeMomentum<S>& c = d.subtree[i].m;
    const Mat3<S>& K = d.subtree[i].K;
    const Vec3<S> total_force = (S(1) / mass) * transposeTimes(R, sum.rate.linear);
    for (int k = x.idx_v; k < x.idx_v + x.nv; ++k) {
      const Motion<S>& s = w.dof[k].S_;
      const DofVariation<S>& change = d.dof[k];
      const DofForces<S>& forces = d.dof_force[k];
      const auto write = [&](S* to, const Force<S>& f) {
        const Vec3<S> linear = R * f.linear, angular = R * (f.angular - cross(y, f.linear));
        for (int r = 0; r < 3; ++r) {
          to[6 * k + r] = linear[r];
          to[6 * k + 3 + r] = angular[r];
        }
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
