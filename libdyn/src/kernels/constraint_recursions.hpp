// Forces of constraints on their way to the world, all rows at once, in packs over rows.
//
// A constraint's row is a unit force on one body, and the opposite one on another. Going up, each degree of freedom takes its share y of the
// force and, where it is free to move (eliminated), passes on what its articulated body does not yield to. The shares are J, or L^-T J^T with
// M = L^T D L; J M^-1 J^T, the Delassus matrix, is Y^T D^-1 Y. O(bodies between constraints and world x rows).
// Featherstone 2008, ch. 7 for the elimination; Popov and Vereshchagin 1978 and Featherstone 2010 (LTL factors, J M^-1 J^T) for its use.
#pragma once

#include "kernels/constrained_bodies.hpp"
#include "kernels/constraint_workspace.hpp"
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

/// A pack of rows, from `first` on, climbs a chain.
template <class Wide, class S>
void climbChain(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, int number, int first, bool eliminated, ConstraintWorkspace& x) {
  const auto load = [](const double* from) { return loadPack<Wide>(from); };
  const auto store = [](const Wide& value, double* to) { storePack(value, to); };
  const auto along = [](const auto& s, const Force<Wide>& f) {
    const Wide linear = Wide(s.linear.x) * f.linear.x + Wide(s.linear.y) * f.linear.y + Wide(s.linear.z) * f.linear.z;
    const Wide angular = Wide(s.angular.x) * f.angular.x + Wide(s.angular.y) * f.angular.y + Wide(s.angular.z) * f.angular.z;
    return linear + angular;
  };
  const ConstrainedChain& chain = c.chains[static_cast<std::size_t>(number)];
  const double* from = x.forceOf(number) + (first - chain.row_begin);
  const std::ptrdiff_t step = x.wholePacks(chain.row_end - chain.row_begin);
  const bool on_joints = c.actsOnJoints();
  Force<Wide> F{{load(from), load(from + step), load(from + 2 * step)}, {load(from + 3 * step), load(from + 4 * step), load(from + 5 * step)}};
  Wide reach = load(from + ConstraintWorkspace::reach * step), free = load(x.free + first), bound = load(x.bound + first);
  for (int place = chain.begin; place < chain.end; ++place) {
    const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
    const auto here = bodies[body];
    const Vec3<double> r = here.r();
    for (int k = 0; k < here.nv(); ++k) {
      const auto dof = here.dof(k);
      const Motion<double> s = dof.S_();
      double* share = x.shareOf(body.dof + k) + first;
      const Wide inverse(dof.inverse());
      Wide y = along(s, F), uncancelled = Wide(dot(s.linear, s.linear)) * dot(F.linear, F.linear) + Wide(dot(s.angular, s.angular)) * reach;
      if (on_joints) {
        const Wide own = load(share);
        y += own;
        uncancelled += own * own;
      }
      const Wide scaled = inverse * y;
      store(y, share);
      store(scaled, x.scaledOf(body.dof + k) + first);
      bound += inverse * uncancelled;
      const bool last = k == here.nv() - 1;
      if (last) {
        free += along(here.beta(), F);
        reach += Wide(dot(r, r)) * dot(F.linear, F.linear);
      }
      if (!eliminated) continue;
      free += y * Wide(dof.y());
      const Wide less = last ? y : scaled;
      const Force<double> W = dof.W();
      if (last) F.angular += cross(cast<Wide>(r), F.linear);  // abaInward has moved this W to the parent
      F.linear -= Vec3<Wide>{less * Wide(W.linear.x), less * Wide(W.linear.y), less * Wide(W.linear.z)};
      F.angular -= Vec3<Wide>{less * Wide(W.angular.x), less * Wide(W.angular.y), less * Wide(W.angular.z)};
    }
    if (!eliminated) F.angular += cross(cast<Wide>(r), F.linear);
  }
  if (chain.parent < 0 && eliminated) {
    const Vec3<double> fall = transposeTimes(x.chains[number].tree.R, -bodies.m.gravity);
    free += Wide(fall.x) * F.linear.x + Wide(fall.y) * F.linear.y + Wide(fall.z) * F.linear.z;
  }
  store(free, x.free + first);
  store(bound, x.bound + first);
  if (chain.parent < 0) return;
  const ConstrainedChain& parent = c.chains[static_cast<std::size_t>(chain.parent)];
  const std::ptrdiff_t parent_step = x.wholePacks(parent.row_end - parent.row_begin);
  double* to = x.forceOf(chain.parent) + (first - parent.row_begin);
  const auto add = [&](int component, const Wide& value) { store(load(to + component * parent_step) + value, to + component * parent_step); };
  for (int a = 0; a < 3; ++a) {
    add(a, F.linear[a]);
    add(3 + a, F.angular[a]);
  }
  add(ConstraintWorkspace::reach, reach);
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
    inPacks<Wide, Half>(chain.row_begin, chain.row_end,
                        [&]<class P>(int first, std::type_identity<P>) { climbChain<P>(bodies, c, number, first, eliminated, x); });
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

/// abaSolve for the bodies between constraints and the world only: their chains' accelerations and x.motion. O(bodies).
template <class S>
void accelerateConstrained(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const Vec3<double>& gravity, ConstraintWorkspace& x) {
  for (std::size_t number = c.chains.size(); number-- > 0;) {
    const ConstrainedChain& chain = c.chains[number];
    Motion<double> a;
    if (chain.parent < 0) {
      a.linear = transposeTimes(x.chains[number].tree.R, -gravity);
    } else {
      a = x.chains[chain.parent].acceleration;
    }
    for (int place = chain.end; place-- > chain.begin;) {
      const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
      const auto here = bodies[body];
      const int last = here.nv() - 1;
      const auto first = here.dof(last);
      double qdd = first.y() - dot(a, first.W());
      if (!here.isRoot()) a.linear += cross(a.angular, here.r());
      a += here.beta() + qdd * first.S_();
      x.motion[body.dof + last] = qdd;
      for (int k = last - 1; k >= 0; --k) {
        const auto f = here.dof(k);
        qdd = f.y() - dot(a, f.W()) * f.inverse();
        a += qdd * f.S_();
        x.motion[body.dof + k] = qdd;
      }
    }
    x.chains[number].acceleration = a;
  }
}

/// Adds to what abaSolve starts from what forces of the constraints, one a row, give to each degree of freedom. O(dofs x rows).
template <class Wide, class Half, class S>
void addConstraintForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const ConstraintWorkspace& x, const double* lambda) {
  for (const ConstrainedBody& body : c.bodies) {
    const auto here = bodies[body];
    const ConstrainedChain& chain = c.chains[static_cast<std::size_t>(body.chain)];
    for (int k = 0; k < here.nv(); ++k) {
      const double* scaled = x.scaledOf(body.dof + k);
      double sum = 0;
      inPacks<Wide, Half>(chain.row_begin, chain.row_end, [&]<class P>(int first, std::type_identity<P>) {
        sum += total<double>(loadPack<P>(scaled + first) * loadPack<P>(lambda + first));
      });
      const auto dof = here.dof(k);
      dof.setY(dof.y() + sum);
    }
  }
}

/// y of these bodies' degrees of freedom. O(dofs).
template <class S>
void forgetForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c) {
  for (const ConstrainedBody& body : c.bodies)
    for (int k = 0; k < bodies[body].nv(); ++k) bodies[body].dof(k).setY(0);
}

}  // namespace dyn::kernels
