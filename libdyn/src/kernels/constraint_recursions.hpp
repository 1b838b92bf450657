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

/// From x.force, where constraints have put their columns (zero elsewhere), and x.share, where those on joints have put theirs.
/// Eliminated: after abaInward; `free` is the acceleration of the rows that abaSolve would find, with the world falling up.
/// Otherwise after abaOutward: shares are J, and `free` is what velocities alone give. Either way the bound is by the degrees of freedom's
/// inverse, which is there once joints have been eliminated, or as the caller has put it. Either way chains have been located.
template <class Wide, class S>
void constraintSweep(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, bool eliminated, ConstraintWorkspace& x) {
  constexpr int width = lanes_of<Wide>, step = ConstraintWorkspace::widest;
  const auto load = [](const double* from) { return loadPack<Wide>(from); };
  const auto store = [](const Wide& value, double* to) { storePack(value, to); };
  std::fill_n(x.free, x.stride, 0.0);
  std::fill_n(x.bound, x.stride, 0.0);
  const bool on_joints = c.actsOnJoints();
  const auto along = [](const auto& s, const Force<Wide>& f) {
    return Wide(s.linear.x) * f.linear.x + Wide(s.linear.y) * f.linear.y + Wide(s.linear.z) * f.linear.z + Wide(s.angular.x) * f.angular.x +
           Wide(s.angular.y) * f.angular.y + Wide(s.angular.z) * f.angular.z;
  };
  for (std::size_t number = 0; number < c.chains.size(); ++number) {
    const ConstrainedChain& chain = c.chains[number];
    for (int first = chain.row_begin / width * width; first < chain.row_end; first += width) {
      const double* from = x.forceOf(static_cast<int>(number), first);
      Force<Wide> F{{load(from), load(from + step), load(from + 2 * step)}, {load(from + 3 * step), load(from + 4 * step), load(from + 5 * step)}};
      Wide free = load(x.free + first), bound = load(x.bound + first), reach = load(from + ConstraintWorkspace::reach * step);
      for (int place = chain.begin; place < chain.end; ++place) {
        const ConstrainedBody& body = c.bodies[static_cast<std::size_t>(place)];
        const auto here = bodies[body];
        const Vec3<double> r = here.r();
        for (int k = 0; k < here.nv(); ++k) {
          const auto dof = here.dof(k);
          const Motion<double> s = dof.S_();
          double* share = x.shareOf(body.dof + k) + first;
          const Wide own = on_joints ? load(share) : Wide(0), y = own + along(s, F), inverse(dof.inverse()), scaled = inverse * y;
          store(y, share);
          store(scaled, x.scaledOf(body.dof + k) + first);
          const bool last = k == here.nv() - 1;
          bound += inverse * (own * own + Wide(dot(s.linear, s.linear)) * dot(F.linear, F.linear) + Wide(dot(s.angular, s.angular)) * reach);
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
      if (chain.parent < 0) continue;
      double* to = x.forceOf(chain.parent, first);
      const auto add = [&](int component, const Wide& value) { store(load(to + component * step) + value, to + component * step); };
      for (int a = 0; a < 3; ++a) {
        add(a, F.linear[a]);
        add(3 + a, F.angular[a]);
      }
      add(ConstraintWorkspace::reach, reach);
    }
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
template <class Wide, class S>
void addConstraintForces(const ConstrainedBodies<S>& bodies, const PackedConstraints& c, const ConstraintWorkspace& x, const double* lambda) {
  constexpr int width = lanes_of<Wide>;
  for (const ConstrainedBody& body : c.bodies) {
    const auto here = bodies[body];
    const ConstrainedChain& chain = c.chains[static_cast<std::size_t>(body.chain)];
    for (int k = 0; k < here.nv(); ++k) {
      const double* scaled = x.scaledOf(body.dof + k);
      Wide sum(0);
      for (int first = chain.row_begin / width * width; first < chain.row_end; first += width)
        sum += loadPack<Wide>(scaled + first) * loadPack<Wide>(lambda + first);
      const auto dof = here.dof(k);
      dof.setY(dof.y() + total<double>(sum));
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
