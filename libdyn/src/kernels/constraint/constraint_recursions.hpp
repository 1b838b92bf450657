// SPDX-License-Identifier: BSD-2-Clause
// The sweep that takes the unit forces of constraint rows to the world, all rows at once, in packs over rows.
//
// A constraint row is a unit force on one body, and the opposite force on another. On the root path, each degree of freedom takes the projection y of
// the force; if joints are eliminated, its response is subtracted from the force. Without elimination the projections are J, with it they are
// Y = L^-T J^T, where M = L^T D L; the Delassus matrix J M^-1 J^T is then Y^T D^-1 Y. O(bodies between constraints and world x rows).
// Featherstone 2008, ch. 7 for the elimination; Popov and Vereshchagin 1978 and Featherstone 2010 (LTL factors, J M^-1 J^T) for its use.
#pragma once

#include "kernels/constraint/constrained_bodies.hpp"
#include "kernels/constraint/constraint_workspace.hpp"
#include "kernels/order/subtree.hpp"
#include "kernels/pack/row_packs.hpp"

namespace dyn::kernels {

/// Writes the positions and velocities in x.chains. After abaOutward. Reads v only if rates is `velocities`. O(bodies).
template <class Bodies, class N = typename Bodies::Number>
void locateChains(const Bodies& bodies, const PackedConstraints& c, const N* v, RowRates rates, BasicConstraintWorkspace<N>& x) {
  for (std::size_t number = c.chains.size(); number-- > 0;) {
    const ConstrainedChain& chain = c.chains[number];
    BasicChainState<N>& state = x.chains[number];
    Vec3<N> arm;
    Motion<N> velocity;
    for (int place = chain.end; place-- > chain.begin;) {
      const auto here = bodies[c.bodies[static_cast<std::size_t>(place)]];
      const Vec3<N> r = here.r();
      arm += r;
      if (rates != RowRates::velocities) continue;
      velocity.linear += cross(velocity.angular, r);
      for (int k = 0; k < here.nv(); ++k) {
        const N rate = v[here.index.idx_v + k];
        const Motion<N> s = here.dof(k).column();
        velocity.angular += rate * s.angular;
        if (!here.index.turns_only) velocity.linear += rate * s.linear;
      }
    }
    const auto first = bodies[c.bodies[static_cast<std::size_t>(chain.begin)]];
    state.R = first.R();
    state.w = rates != RowRates::none ? first.w() : Vec3<N>{};
    state.arm = arm;
    state.velocity = velocity;
    state.tree = chain.parent < 0 ? bodies[c.bodies[static_cast<std::size_t>(chain.end - 1)]].tree() : x.chains[chain.parent].tree;
  }
}

/// A pack of rows on the root path: their forces, and their reach, carried and bound as in ConstraintWorkspace::forceOf.
template <class P>
struct ClimbingRows {
  Force<P> F;
  P reach, carried, bound;
};

/// Projects out a plain floating base, whose columns are its axes: one axis after the other, until nothing is left of the forces. No row may act on a
/// joint.
template <class P, int packs, class Body, class N>
[[gnu::always_inline]] inline void projectOutPlainFloatingBase(const Body& root, N* projections, N* scaled, std::ptrdiff_t room, N* response,
                                                               ClimbingRows<P> (&rows)[packs]) {
  constexpr int lanes = rows_of<P, N>;
  const auto of = [](Force<P>& F, int axis) -> P& { return axis < 3 ? F.linear[axis] : F.angular[axis - 3]; };
#pragma GCC unroll 6
  for (int k = 0; k < 6; ++k, projections += room, scaled += room) {
    const auto dof = root.dof(k);
    const Force<P> W = dof.template W<P>();
    const P inverse = dof.template inverse<P>();
    response[k] = dof.y();
    for (int p = 0; p < packs; ++p) {
      ClimbingRows<P>& row = rows[p];
      const P y = of(row.F, k), uncancelled = k < 3 ? dot(row.F.linear, row.F.linear) : row.reach;
      const P given = inverse * y;
      storePack(y, projections + p * lanes);
      storePack(given, scaled + p * lanes);
      row.bound += inverse * uncancelled;
      of(row.F, k) = P(0);
#pragma GCC unroll 6
      for (int axis = k + 1; axis < 6; ++axis) of(row.F, axis) -= given * (axis < 3 ? W.linear[axis] : W.angular[axis - 3]);
    }
  }
}

/// Takes `packs` packs of rows, from `first` on, along a chain. At each degree of freedom a pack waits only for its own numbers, so several packs
/// overlap. `contacts`: joints have been eliminated and all rows act on bodies, which is nearly always so.
template <class P, int packs, bool contacts, class Bodies, class N = typename Bodies::Number>
void climbChain(const Bodies& bodies, const PackedConstraints& c, int number, int first, bool has_eliminated, BasicConstraintWorkspace<N>& x) {
  const bool eliminated = contacts || has_eliminated, on_joints = !contacts && c.actsOnJoints();
  constexpr int lanes = rows_of<P, N>;
  const ConstrainedChain& chain = c.chains[static_cast<std::size_t>(number)];
  const std::ptrdiff_t step = x.forceStep(chain);
  ClimbingRows<P> rows[packs];
  for (int p = 0; p < packs; ++p) {
    const int row = first + p * lanes;
    const auto force = [&](int component) { return loadPack<P>(x.forceOf(number) + component * step + (row - chain.row_begin)); };
    rows[p] = {{{force(0), force(1), force(2)}, {force(3), force(4), force(5)}}, force(x.reach), force(x.carried_below), force(x.bound_below)};
  }
  for (int place = chain.begin; place < chain.end; ++place) {
    const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
    const auto here = bodies[body];
    if (eliminated && !on_joints && here.isPlainFloatingBase()) {
      projectOutPlainFloatingBase(here, x.projectionOf(body.dof) + first, x.scaledOf(body.dof) + first, x.room, x.response + body.dof, rows);
      break;
    }
    const Vec3<P> r = here.template r<P>();
    const P far = dot(r, r);
    const int nv = here.nv();
    const bool turns_only = here.index.turns_only;
    for (int k = 0; k < nv; ++k) {
      const auto dof = here.dof(k);
      const Motion<P> s = dof.template column<P>();
      const P inverse = dof.template inverse<P>(), reach_of_angular = dot(s.angular, s.angular);
      const bool last = k == nv - 1;
      x.response[body.dof + k] = dof.y();
      N *const projections = x.projectionOf(body.dof + k) + first, *const scaled_projections = x.scaledOf(body.dof + k) + first;
      for (int p = 0; p < packs; ++p) {
        ClimbingRows<P>& row = rows[p];
        Force<P>& F = row.F;
        const P far_off = dot(F.linear, F.linear);
        P y = dot(s.angular, F.angular), uncancelled = reach_of_angular * row.reach;
        if (!turns_only) {
          y += dot(s.linear, F.linear);
          uncancelled += dot(s.linear, s.linear) * far_off;
        }
        if (on_joints) {
          const P own = loadPack<P>(projections + p * lanes);
          y += own;
          uncancelled += own * own;
        }
        const P scaled = inverse * y;
        storePack(y, projections + p * lanes);
        storePack(scaled, scaled_projections + p * lanes);
        row.bound += inverse * uncancelled;
        if (last) {
          row.carried += dot(here.template beta<P>(), F);
          row.reach += far * far_off;
        }
        if (!eliminated) continue;
        const P less = last ? y : scaled;
        if (last) F.angular += cross(r, F.linear);  // this W is about the parent's origin (abaInward)
        F -= less * dof.template W<P>();
      }
    }
    if (!eliminated)
      for (ClimbingRows<P>& row : rows) row.F.angular += cross(r, row.F.linear);
  }
  Vec3<N> fall;
  if (chain.parent < 0 && eliminated) fall = transposeTimes(x.chains[number].tree.R, -cast<N>(bodies.m.gravity));
  for (int p = 0; p < packs; ++p) {
    const ClimbingRows<P>& row = rows[p];
    const int at = first + p * lanes, count = chain.row_end - at;
    // A chain that is alone stores without adding: sums would wait for the numbers that neighbours have just written.
    const auto hand = [&](const P& value, N* to) {
      if (chain.alone) {
        storeFirst(value, count, to);
      } else {
        storePack(loadPack<P>(to) + value, to);
      }
    };
    const P carried = row.carried + dot(cast<P>(fall), row.F.linear);
    if (chain.parent < 0) {
      hand(carried, x.carried + at);
      hand(row.bound, x.bound + at);
      continue;
    }
    const ConstrainedChain& parent = c.chains[static_cast<std::size_t>(chain.parent)];
    const std::ptrdiff_t parent_step = x.forceStep(parent);
    N* to = x.forceOf(chain.parent) + (at - parent.row_begin);
    for (int a = 0; a < 3; ++a) {
      hand(row.F.linear[a], to + a * parent_step);
      hand(row.F.angular[a], to + (3 + a) * parent_step);
    }
    hand(row.reach, to + x.reach * parent_step);
    hand(carried, to + x.carried_below * parent_step);
    hand(row.bound, to + x.bound_below * parent_step);
  }
}

/// The sweep over all chains, which have been located. Reads the rows' unit forces from x.force (zero elsewhere), and those of rows on joints from
/// x.projection. Writes x.projection, x.scaled, x.carried, x.bound and x.response.
/// Eliminated: after abaInward. x.response gets y, from which abaSolve starts, and x.carried the rows' accelerations without that response, with an
/// acceleration of -gravity of the world. Not eliminated: after abaOutward. The projections are J, and x.carried is the effect of velocities.
/// x.bound needs the inverse pivots of the degrees of freedom: abaInward has written them, or else the caller must.
template <class Wide, class Half, class Bodies, class N = typename Bodies::Number>
void constraintSweep(const Bodies& bodies, const PackedConstraints& c, bool eliminated, BasicConstraintWorkspace<N>& x) {
  if (c.gathers) {
    std::fill_n(x.carried, x.room, N(0));
    std::fill_n(x.bound, x.room, N(0));
  }
  const bool contacts = eliminated && !c.actsOnJoints();
  int number = 0;
  for (const ConstrainedChain& chain : c.chains) {
    inGroups<Wide, Half, N>(chain.row_begin, chain.row_end,
                            [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
                              // Packs of states take so long that it does not pay to compile the decision into them.
                              constexpr bool decide = lanes_of<N> == 1;
                              if (decide && contacts) return climbChain<P, packs, decide>(bodies, c, number, first, eliminated, x);
                              climbChain<P, packs, false>(bodies, c, number, first, eliminated, x);
                            });
    ++number;
  }
}

/// The elimination for one force F a body and one projection a degree of freedom: writes the response of each degree of freedom to y. Destroys F.
/// O(bodies).
template <class S>
void projectOutOfForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, Force<double>* F, const double* projections) {
  for (std::size_t place = 0; place < c.bodies.size(); ++place) {
    const ConstrainedBody& body = c.bodies[place];
    const auto here = bodies[body];
    Force<double> f = F[place];
    for (int k = 0; k < here.nv(); ++k) {
      const auto dof = here.dof(k);
      const double projection = projections[body.dof + k] + dot(dof.column(), f), scaled = dof.inverse() * projection;
      dof.setY(scaled);
      const bool last = k == here.nv() - 1;
      if (last) f.angular += cross(here.r(), f.linear);
      f -= (last ? projection : scaled) * dof.W();
    }
    if (!here.isRoot()) F[c.body_at[static_cast<std::size_t>(here.index.parent)]] += f;
  }
}

/// Copies the accelerations of the chains' first bodies, which abaSolve has written, to x.chains. O(chains).
template <class S>
void takeAccelerations(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, ConstraintWorkspace& x) {
  for (std::size_t number = 0; number < c.chains.size(); ++number)
    x.chains[number].acceleration = bodies[c.bodies[static_cast<std::size_t>(c.chains[number].begin)]].acceleration();
}

/// Copies x.response to y, from which abaSolve starts. O(dofs).
template <class S>
void takeResponse(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const ConstraintWorkspace& x) {
  if constexpr (lanes_of<S> == 1) {
    for (std::size_t k = 0; k < c.dofs.size(); ++k) bodies.w.dof[c.dofs[k]].y = x.response[k];
  } else {
    for (const ConstrainedLaneGroupDof& at : c.group_dofs) {
      S& y = bodies.w.dof[at.group_dof].y;
      const S response = gathered<S>(x.response, at.dofs);
      y = at.lanes == (1U << group_lanes) - 1 ? response : select(lanes<S>(at.lanes), response, y);
    }
  }
}

/// Sets y of these bodies' degrees of freedom to zero. O(dofs).
template <class S>
void forgetForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c) {
  for (const ConstrainedBody& body : c.bodies)
    for (int k = 0; k < bodies[body].nv(); ++k) bodies[body].dof(k).setY(0);
}

}  // namespace dyn::kernels
