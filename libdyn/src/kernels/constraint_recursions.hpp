// Forces of constraints on their way to the world, all rows at once, in packs over rows.
//
// A constraint's row is a unit force on one body, and the opposite one on another. Going up, each degree of freedom takes its share y of the
// force and, where it is free to move (eliminated), passes on what its articulated body does not yield to. The shares are J, or L^-T J^T with
// M = L^T D L; J M^-1 J^T, the Delassus matrix, is Y^T D^-1 Y. O(bodies between constraints and world x rows).
// Featherstone 2008, ch. 7 for the elimination; Popov and Vereshchagin 1978 and Featherstone 2010 (LTL factors, J M^-1 J^T) for its use.
#pragma once

#include "kernels/constrained_bodies.hpp"
#include "kernels/constraint_workspace.hpp"
#include "kernels/row_packs.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// Places and velocities in x.chains. After abaOutward; v may be null (at rest). O(bodies).
template <class S>
void locateChains(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const double* v, ConstraintWorkspace& x) {
  for (std::size_t number = c.chains.size(); number-- > 0;) {
    const ConstrainedChain& chain = c.chains[number];
    ChainState& state = x.chains[number];
    Vec3<double> lever;
    Motion<double> velocity;
    for (int place = chain.end; place-- > chain.begin;) {
      const auto here = bodies[c.bodies[static_cast<std::size_t>(place)]];
      const Vec3<double> r = here.r();
      lever += r;
      if (v == nullptr) continue;
      velocity.linear += cross(velocity.angular, r);
      for (int k = 0; k < here.nv(); ++k) velocity += v[here.index.idx_v + k] * here.dof(k).S_();
    }
    const auto first = bodies[c.bodies[static_cast<std::size_t>(chain.begin)]];
    state.R = first.R();
    state.w = v ? first.w() : Vec3<double>{};
    state.lever = lever;
    state.velocity = velocity;
    state.tree = chain.parent < 0 ? bodies[c.bodies[static_cast<std::size_t>(chain.end - 1)]].tree() : x.chains[chain.parent].tree;
  }
}

/// A pack of rows on its way to the world.
template <class P>
struct ClimbingRows {
  Force<P> F;
  P reach, free, bound;
};

/// As many packs of rows side by side, from `first` on, climb a chain: each waits for its own numbers at every degree of freedom.
template <class P, int packs, class S>
void climbChain(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, int number, int first, bool eliminated, ConstraintWorkspace& x) {
  constexpr int lanes = lanes_of<P>;
  const auto along = [](const Motion<double>& s, const Force<P>& f) { return dot(cast<P>(s.linear), f.linear) + dot(cast<P>(s.angular), f.angular); };
  const ConstrainedChain& chain = c.chains[static_cast<std::size_t>(number)];
  const std::ptrdiff_t step = x.wholePacks(chain.row_end - chain.row_begin);
  const bool on_joints = c.actsOnJoints();
  ClimbingRows<P> rows[packs];
  for (int p = 0; p < packs; ++p) {
    const int row = first + p * lanes;
    const auto force = [&](int component) { return loadPack<P>(x.forceOf(number) + component * step + (row - chain.row_begin)); };
    rows[p] = {{{force(0), force(1), force(2)}, {force(3), force(4), force(5)}},
               force(ConstraintWorkspace::reach),
               loadPack<P>(x.free + row),
               loadPack<P>(x.bound + row)};
  }
  for (int place = chain.begin; place < chain.end; ++place) {
    const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
    const auto here = bodies[body];
    const Vec3<double> r = here.r();
    const P far(dot(r, r));
    for (int k = 0; k < here.nv(); ++k) {
      const auto dof = here.dof(k);
      const Motion<double> s = dof.S_(), beta = here.beta();
      const Force<double> W = dof.W();
      const P inverse(dof.inverse()), y_free(dof.y()), reach_of_linear(dot(s.linear, s.linear)), reach_of_angular(dot(s.angular, s.angular));
      const bool last = k == here.nv() - 1;
      double *const shares = x.shareOf(body.dof + k) + first, *const scaled_shares = x.scaledOf(body.dof + k) + first;
      for (int p = 0; p < packs; ++p) {
        ClimbingRows<P>& row = rows[p];
        Force<P>& F = row.F;
        const P far_off = dot(F.linear, F.linear);
        P y = along(s, F), uncancelled = reach_of_linear * far_off + reach_of_angular * row.reach;
        if (on_joints) {
          const P own = loadPack<P>(shares + p * lanes);
          y += own;
          uncancelled += own * own;
        }
        const P scaled = inverse * y;
        storePack(y, shares + p * lanes);
        storePack(scaled, scaled_shares + p * lanes);
        row.bound += inverse * uncancelled;
        if (last) {
          row.free += along(beta, F);
          row.reach += far * far_off;
        }
        if (!eliminated) continue;
        row.free += y * y_free;
        const P less = last ? y : scaled;
        if (last) F.angular += cross(cast<P>(r), F.linear);  // abaInward has moved this W to the parent
        F.linear -= less * cast<P>(W.linear);
        F.angular -= less * cast<P>(W.angular);
      }
    }
    if (!eliminated)
      for (ClimbingRows<P>& row : rows) row.F.angular += cross(cast<P>(r), row.F.linear);
  }
  Vec3<double> fall;
  if (chain.parent < 0 && eliminated) fall = transposeTimes(x.chains[number].tree.R, -bodies.m.gravity);
  for (int p = 0; p < packs; ++p) {
    const ClimbingRows<P>& row = rows[p];
    const int at = first + p * lanes;
    storePack(row.free + dot(cast<P>(fall), row.F.linear), x.free + at);
    storePack(row.bound, x.bound + at);
    if (chain.parent < 0) continue;
    const ConstrainedChain& parent = c.chains[static_cast<std::size_t>(chain.parent)];
    const std::ptrdiff_t parent_step = x.wholePacks(parent.row_end - parent.row_begin);
    double* to = x.forceOf(chain.parent) + (at - parent.row_begin);
    const auto add = [&](int component, const P& value) {
      double* sum = to + component * parent_step;
      storePack(loadPack<P>(sum) + value, sum);
    };
    for (int a = 0; a < 3; ++a) {
      add(a, row.F.linear[a]);
      add(3 + a, row.F.angular[a]);
    }
    add(ConstraintWorkspace::reach, row.reach);
  }
}

/// From x.force, where constraints have put their columns (zero elsewhere), and x.share, where those on joints have put theirs.
/// Eliminated: after abaInward; `free` is the acceleration of the rows that abaSolve would find, with the world falling up.
/// Otherwise after abaOutward: shares are J, and `free` is what velocities alone give. Either way the bound is by the degrees of freedom's
/// inverse, which is there once joints have been eliminated, or as the caller has put it. Either way chains have been located.
template <class Wide, class Half, class S>
void constraintSweep(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
  std::fill_n(x.free, x.room, 0.0);
  std::fill_n(x.bound, x.room, 0.0);
  int number = 0;
  for (const ConstrainedChain& chain : c.chains) {
    inGroups<Wide, Half>(chain.row_begin, chain.row_end,
                         [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
                           climbChain<P, packs>(bodies, c, number, first, eliminated, x);
                         });
    ++number;
  }
}

/// One force F a body and one share a degree of freedom, climbing as rows do: leaves in y what each degree of freedom yields. Destroys F. O(bodies).
template <class S>
void yieldToForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, Force<double>* F, const double* shares) {
  for (std::size_t place = 0; place < c.bodies.size(); ++place) {
    const ConstrainedBody& body = c.bodies[place];
    const auto here = bodies[body];
    Force<double> f = F[place];
    for (int k = 0; k < here.nv(); ++k) {
      const auto dof = here.dof(k);
      const double share = shares[body.dof + k] + dot(dof.S_(), f), scaled = dof.inverse() * share;
      dof.setY(scaled);
      const bool last = k == here.nv() - 1;
      if (last) f.angular += cross(here.r(), f.linear);
      f -= (last ? share : scaled) * dof.W();
    }
    if (!here.isRoot()) F[c.body_at[static_cast<std::size_t>(here.index.parent)]] += f;
  }
}

/// What abaSolve has left of the chains' first bodies, to x.chains. O(chains).
template <class S>
void takeAccelerations(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, ConstraintWorkspace& x) {
  for (std::size_t number = 0; number < c.chains.size(); ++number)
    x.chains[number].acceleration = bodies[c.bodies[static_cast<std::size_t>(c.chains[number].begin)]].acceleration();
}

/// Adds to what abaSolve starts from what forces of the constraints, one a row, give to each degree of freedom. O(dofs x rows).
template <class Wide, class Half, class S>
void addConstraintForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const ConstraintWorkspace& x, const double* lambda) {
  for (const ConstrainedChain& chain : c.chains)
    inGroups<Wide, Half>(chain.row_begin, chain.row_end,
                         [&]<class P, int packs>(int first, std::type_identity<P>, std::integral_constant<int, packs>) {
                           P forces[packs];
                           for (int p = 0; p < packs; ++p) forces[p] = loadPack<P>(lambda + first + p * lanes_of<P>);
                           for (int place = chain.begin; place < chain.end; ++place) {
                             const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
                             const auto here = bodies[body];
                             for (int k = 0; k < here.nv(); ++k) {
                               const double* scaled = x.scaledOf(body.dof + k) + first;
                               P sum = loadPack<P>(scaled) * forces[0];
                               for (int p = 1; p < packs; ++p) sum += loadPack<P>(scaled + p * lanes_of<P>) * forces[p];
                               const auto dof = here.dof(k);
                               dof.setY(dof.y() + total<double>(sum));
                             }
                           }
                         });
}

/// y of these bodies' degrees of freedom. O(dofs).
template <class S>
void forgetForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c) {
  for (const ConstrainedBody& body : c.bodies)
    for (int k = 0; k < bodies[body].nv(); ++k) bodies[body].dof(k).setY(0);
}

}  // namespace dyn::kernels
