// Momentum about the centre of mass, its rate, and their derivatives, from what the derivatives of inverse dynamics have of each subtree.
//
// Everything is summed in aligned frames about the joints' own origins, in inertial frames that move with them, and moved to the centre of
// mass last: by y, from the joint's origin to the centre, and its rate. No position in the world enters.
#pragma once

#include "kernels/centroidal_map.hpp"
#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// The root of a tree: its axes in the world, where its joint's origin is and how fast, what hangs on it in its own axes.
template <class S>
struct TreeRoot {
  Mat3<S> R;
  Vec3<S> origin, speed;
  const SubtreeMomentum<S>& m;
  const Force<S>& f;
};
template <class S>
TreeRoot<S> treeRoot(const BodyIndex& root, const SE3<S>& rel, const Vec3<S>& r, const Vec3<S>& shift_rate, const Subtree<S>& subtree) {
  const Mat3<S> R = root.flying_root ? rel.R : Mat3<S>::identity();
  return {R, root.flying_root ? rel.p : r, R * shift_rate, subtree.m, subtree.f};
}

/// The whole: rootOf(i) is the tree's whose root is body i. `places` gets for each root where its joint's origin is, seen from the centre of mass,
/// and how fast it leaves that, in its own axes. The trees that stand on the world are one system: where there are several, their places in the world
/// are compared.
template <class S, class RootOf>
CentroidalState<S> centroidalState(const CompactImpl& m, RootOf&& rootOf, Motion<S>* places) {
  const auto next = [&](int root) { return m.tree_end[static_cast<std::size_t>(root)]; };
  // The first root is where the others are seen from.
  const int first = 1, count = m.bodies();
  const TreeRoot<S> reference = rootOf(first);
  S mass(0);
  Vec3<S> moment, flow;  // of mass, and of momentum, about the first root's origin and relative to its speed; world axes
  for (int i = first; i < count; i = next(i)) {
    const TreeRoot<S> root = i == first ? reference : rootOf(i);
    mass += root.m.mass;
    moment += root.R * root.m.h;
    flow += root.R * root.m.momentum.linear;
    if (i == first) continue;
    moment += root.m.mass * (root.origin - reference.origin);
    flow += root.m.mass * (root.speed - reference.speed);
  }
  const Vec3<S> centre = (S(1) / mass) * moment, drift = (S(1) / mass) * flow;

  CentroidalState<S> sum{};
  sum.mass = mass;
  for (int i = first; i < count; i = next(i)) {
    const TreeRoot<S> root = i == first ? reference : rootOf(i);
    const Mat3<S>& R = root.R;
    const SubtreeMomentum<S>& c = root.m;
    const Vec3<S> apart = i == first ? Vec3<S>{} : root.origin - reference.origin, parting = i == first ? Vec3<S>{} : root.speed - reference.speed;
    const Motion<S> place{transposeTimes(R, centre - apart), transposeTimes(R, drift - parting)};
    places[i] = place;
    const auto about = [&](const Force<S>& f) { return Force<S>{R * f.linear, R * (f.angular - cross(place.linear, f.linear))}; };
    // Relative to the centre's own speed the whole has no linear momentum: that of the world is added at the end.
    const Vec3<S> linear = c.momentum.linear - c.mass * place.angular;
    sum.momentum += about({linear, c.momentum.angular - cross(c.h, place.angular)});
    sum.rate += about(root.f);
    sum.inertia += congruence(R, shiftedInertia(c.I, c.mass, c.h, -place.linear));
  }
  sum.momentum.linear = mass * (reference.speed + drift);
  return sum;
}

/// Of a tree: its axes, and the force on it, divided by the whole's mass, in them.
template <class S>
struct TreeAxes {
  Mat3<S> R;
  Vec3<S> force;
};
template <class S>
TreeAxes<S> treeAxes(const Mat3<S>& R, const CentroidalState<S>& sum) {
  return {R, (S(1) / sum.mass) * transposeTimes(R, sum.rate.linear)};
}

/// What one degree of freedom's column of each map is: write(map, force) for those that are wanted, the force in world axes about the centre of mass.
template <class S, class N, class Write>
void centroidalColumns(const CentroidalMaps<N>& out, const TreeAxes<S>& tree, const Motion<S>& place, const Subtree<S>& c, const Motion<S>& s,
                       const DofVariation<S>& change, const DofForces<S>& forces, Write&& write) {
  const Vec3<S>&y = place.linear, &dy = place.angular;
  const auto put = [&](N* to, const Force<S>& f) { write(to, Force<S>{tree.R * f.linear, tree.R * (f.angular - cross(y, f.linear))}); };
  const Force<S>& U = forces.by_a;
  if (out.Ag) put(out.Ag, U);
  const auto inertiaTimes = [&](const Motion<S>& b) { return rigidForce(c.m, b); };
  if (out.dAg) {
    // d(I s)/dt = I ds/dt + (v x* I - I v x) s, of which coriolis() is the second part plus s x* (momentum).
    const Motion<S> ds = change.rate - change.velocity;
    const Force<S> rate = inertiaTimes(ds) + coriolis(c.m, turningTorque(c.K), s.angular) - turned(s, c.m.momentum);
    put(out.dAg, {rate.linear, rate.angular - cross(dy, U.linear)});
  }
  if (out.dh_dq) {
    const Force<S> change_of_momentum = turned(s, c.m.momentum) + inertiaTimes(change.velocity);
    put(out.dh_dq, {change_of_momentum.linear, change_of_momentum.angular + cross(dy, U.linear)});
  }
  if (out.dhdot_dq) {
    const Force<S>& by_q = forces.by_q;
    put(out.dhdot_dq, {by_q.linear, by_q.angular - cross(U.linear, tree.force)});
  }
  if (out.dhdot_dv) put(out.dhdot_dv, forces.by_v);
}

/// After derivativesOutward without gravity and derivativesInward.
template <class S, class Order>
CentroidalState<S> centroidalOf(const Order& bodies, DerivativeWorkspace<S>& d, const CentroidalMaps<S> out) {
  const Workspace<S>& w = bodies.w;
  // Copies: what vectors are stored into might be anything, even what says where.
  const int count = bodies.m.bodies();
  const BodyIndex* const index = bodies.m.index.data();
  Motion<S>* const places = d.place;
  const Vec3<S>* const rs = w.r;
  const Vec3<S>* const rates = d.shift_rate;
  const Subtree<S>* const subtrees = d.subtree;
  const DofFactor<S>* const dofs = w.dof;
  const DofVariation<S>* const variations = d.dof;
  const DofForces<S>* const dof_forces = d.dof_force;
  const auto rootOf = [&](int i) { return treeRoot(index[i], w.rel[i], rs[i], rates[i], subtrees[i]); };
  CentroidalState<S> sum = centroidalState<S>(bodies.m, rootOf, places);
  // From each root to its leaves.
  TreeAxes<S> tree;
  for (int i = 1; i < count; ++i) {
    const BodyIndex& x = index[i];
    Motion<S>& place = places[i];
    if (x.parent == 0) {
      tree = treeAxes(x.flying_root ? w.rel[i].R : Mat3<S>::identity(), sum);
    } else {
      place.linear = places[x.parent].linear - rs[i];
      place.angular = places[x.parent].angular - rates[i];
    }
    for (int k = x.idx_v; k < x.idx_v + x.nv; ++k)
      centroidalColumns(out, tree, place, subtrees[i], dofs[k].S_, variations[k], dof_forces[k],
                        [&](S* to, const Force<S>& f) { putSix(f, to + 6 * k); });
  }
  return sum;
}
/// Joints have been asked into w and, for more than Ag and momentum, how subspaces vary into d.
template <class S>
CentroidalState<S> centroidal(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* a,
                              const CentroidalMaps<S>& out) {
  const auto r = recursion(m, w, d);
  using T = typename decltype(r)::Scalar;
  if (!out.rates()) return inNumbers<S>(centroidalMap(r.order, r.velocities(v), BodyMap<T>{r.out(out.Ag)}));
  derivativesOutward(r.order, r.d, Vec3<T>{}, r.velocities(v), r.accelerations(a));
  derivativesInward(r.order, r.d);
  return inNumbers<S>(centroidalOf(r.order, r.d, {r.out(out.Ag), r.out(out.dAg), r.out(out.dh_dq), r.out(out.dhdot_dq), r.out(out.dhdot_dv)}));
}

}  // namespace dyn::kernels
