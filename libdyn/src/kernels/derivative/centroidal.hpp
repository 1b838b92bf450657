// SPDX-License-Identifier: BSD-2-Clause
// Momentum about the centre of mass, its rate, the centroidal momentum matrix Ag (Orin and Goswami 2008) and their derivatives. O(n).
//
// Sums are in aligned axes about the joints' own origins, in inertial frames that move with these origins. They are moved to the centre of mass
// last: by y, from the joint's origin to the centre, and its rate dy. Positions in the world enter only where there are several trees.
// Letters, rigid() and coriolis() as in rnea_derivatives.hpp, without gravity and external forces. With R the tree's aligned axes in the world,
// S x* f = (S_w x f.linear, S_w x f.angular + S_v x f.linear), and X(f) = (R f.linear, R (f.angular - y x f.linear)), sums over the trees' roots:
//
//   (1)  mass = sum of m,   y = y_p - r,   dy = dy_p - shift_rate                 p: the parent; at the roots y and dy are to the whole's centre
//   (2)  momentum.angular = sum of X(momentum.linear - m dy, momentum.angular - h x dy).angular,   momentum.linear = mass * velocity of the centre
//   (3)  rate = sum of X(f),   inertia = sum of R shiftedInertia(I, m, h, -y) R^T                   about the centre of mass, world axes
// For each degree of freedom a column, with U = by_a and force = R^T rate.linear / mass:
//   (4)  Ag       = X(U)
//   (5)  dAg      = X(rigid(rate - velocity) + coriolis(S_w) - S x* momentum - (0, dy x U.linear))
//   (6)  dh_dq    = X(S x* momentum + rigid(velocity) + (0, dy x U.linear))
//   (7)  dhdot_dq = X(by_q - (0, U.linear x force)),   dhdot_dv = X(by_v)
#pragma once

#include "kernels/derivative/rnea_derivatives.hpp"
#include "kernels/recursion/centroidal_map.hpp"

namespace dyn::kernels {

/// The root of a tree: its axes in the world, position and velocity of its joint's origin in world axes, and its subtree's values in its own axes.
template <class S>
struct TreeRoot {
  Mat3<S> R;
  Vec3<S> origin, speed;
  const SubtreeMomentum<S>& m;
  const Force<S>& f;
};
template <class S>
TreeRoot<S> treeRoot(const BodyIndex& root, const SE3<S>& rel, const Vec3<S>& r, const Vec3<S>& shift_rate, const Subtree<S>& subtree) {
  const Mat3<S> R = root.floating_base ? rel.R : Mat3<S>::identity();
  return {R, root.floating_base ? rel.p : r, R * shift_rate, subtree.m, subtree.f};
}

/// (1) to (3) for the whole system. rootOf(i) is the TreeRoot of the tree whose root is body i. places[i] gets y and dy of each root, in its own
/// axes. All trees are one system: where there are several, their positions in the world are compared.
template <class S, class RootOf>
CentroidalState<S> centroidalState(const CompactImpl& m, RootOf&& rootOf, Motion<S>* places) {
  const auto next = [&](int root) { return m.tree_end[static_cast<std::size_t>(root)]; };
  // The first root is the reference of the others.
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
    // Relative to the centre's velocity the whole has no linear momentum; the linear momentum in the world is written at the end.
    const Vec3<S> linear = c.momentum.linear - c.mass * place.angular;
    sum.momentum += about({linear, c.momentum.angular - cross(c.h, place.angular)});
    sum.rate += about(root.f);
    sum.inertia += congruence(R, shiftedInertia(c.I, c.mass, c.h, -place.linear));
  }
  sum.momentum.linear = mass * (reference.speed + drift);
  return sum;
}

/// The axes of a tree in the world, and in them the force on the whole system over its mass.
template <class S>
struct TreeAxes {
  Mat3<S> R;
  Vec3<S> force;
};
template <class S>
TreeAxes<S> treeAxes(const Mat3<S>& R, const CentroidalState<S>& sum) {
  return {R, (S(1) / sum.mass) * transposeTimes(R, sum.rate.linear)};
}

/// (4) to (7): the columns of one degree of freedom. Calls write(map, force) for each wanted map, with the force in world axes about the centre of
/// mass.
template <class S, class N, class Write>
void centroidalColumns(const CentroidalMaps<N>& out, const TreeAxes<S>& tree, const Motion<S>& place, const Subtree<S>& c, const Motion<S>& s,
                       const DofVariation<S>& change, const DofForces<S>& forces, Write&& write) {
  const Vec3<S>&y = place.linear, &dy = place.angular;
  const auto put = [&](N* to, const Force<S>& f) { write(to, Force<S>{tree.R * f.linear, tree.R * (f.angular - cross(y, f.linear))}); };
  const Force<S>& U = forces.by_a;
  if (out.Ag) put(out.Ag, U);
  const auto inertiaTimes = [&](const Motion<S>& b) { return rigidForce(c.m, b); };
  if (out.dAg) {
    // d(I S)/dt = I dS/dt + (v x* I - I v x) S, where the second term is coriolis(S_w) - S x* momentum.
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
  // Copies: the compiler must assume that stores of vectors may change anything, even the pointers.
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
      tree = treeAxes(x.floating_base ? w.rel[i].R : Mat3<S>::identity(), sum);
    } else {
      place.linear = places[x.parent].linear - rs[i];
      place.angular = places[x.parent].angular - rates[i];
    }
    for (int k = x.idx_v; k < x.idx_v + x.nv; ++k)
      centroidalColumns(out, tree, place, subtrees[i], dofs[k].column, variations[k], dof_forces[k],
                        [&](S* to, const Force<S>& f) { putSix(f, to + 6 * k); });
  }
  return sum;
}
/// All wanted values. w has the evaluated joints. d has the derivatives of their subspaces, unless only Ag and the momentum are wanted.
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
