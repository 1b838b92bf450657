// Matrices with entries for two degrees of freedom on one path to the root: forces of neighbours climb together, and stay in registers on their way.
#pragma once

#include "kernels/recursion.hpp"
#include "kernels/subtree.hpp"

namespace dyn::kernels {

/// Forces of neighbouring degrees of freedom, as many as Wide has lanes from `first` on, those past the n-th being the last one's. Vectors begin four
/// packs apart, as they do in registers.
template <class Wide, template <class> class Forces>
class ForcesAbreast {
 public:
  ForcesAbreast(const DofForces<Vectored>* forces, int first, int n) {
    const double* from[lanes_of<Wide>];
    for (int l = 0; l < lanes_of<Wide>; ++l) from[l] = reinterpret_cast<const double*>(forces + std::min(first + l, n - 1));
    gatherStructs<numbers>(from, x_);
  }
  Forces<Wide> get() const {
    if constexpr (numbers == 8) {
      return force(0);
    } else {
      return {force(0), vector(2), force(3), force(5)};
    }
  }
  /// What climbing changes: linear parts are the same wherever forces are.
  void leave(const Force<Wide>& f, int i = 0) { put(i + 1, f.angular); }
  void leave(const DofForces<Wide>& f) {
    leave(f.by_a);
    put(2, f.lever);
    leave(f.by_q, 3);
    leave(f.by_v, 5);
  }

 private:
  static constexpr int numbers = sizeof(Forces<Vectored>) / sizeof(double);
  Vec3<Wide> vector(int i) const { return {x_[4 * i], x_[4 * i + 1], x_[4 * i + 2]}; }
  Force<Wide> force(int i) const { return {vector(i), vector(i + 1)}; }
  void put(int i, const Vec3<Wide>& v) {
    for (int k = 0; k < 3; ++k) x_[4 * i + k] = v[k];
  }
  Wide x_[numbers];
};
/// The same of those that are in lanes where they are.
template <class S>
void leave(const Force<S>& f, Force<S>& at) {
  at.angular = f.angular;
}
template <class S>
void leave(const DofForces<S>& f, DofForces<S>& at) {
  leave(f.by_a, at.by_a);
  at.lever = f.lever;
  leave(f.by_q, at.by_q);
  leave(f.by_v, at.by_v);
}

/// Neighbouring degrees of freedom, as many as Wide has lanes, on their paths to the root: calls along.operator()<Joint>(each) for joints of one
/// shape, and each(visit) calls visit(F, i, idx_v, part) for these joints' bodies, children first: F, the neighbours' forces, are to be moved to the
/// parent's origin, and `part` is what of the neighbours is in the subtree of body i.
template <template <class> class Forces, class Wide, class S, class R, class Along>
void forcesToRoot(const R& recursion, Along&& along) {
  constexpr int width = Part<Wide, S>::width;
  const auto& order = recursion.order;
  const int n = order.m.nvx;
  if constexpr (std::is_same_v<typename R::Scalar, Wide>) {
    // They are in lanes where they are: all of a subtree's one after the other at each joint.
    order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
      along.template operator()<Joint>([&](auto&& visit) {
        const int end = order.dofEnd(i);
        auto* const forces = recursion.d.dof_force;
        order.eachDof(iv, end, [&](int dof) {
          auto& place = reinterpret_cast<Forces<Wide>&>(forces[dof]);
          Forces<Wide> F = place;
          visit(F, i, iv, Part<Wide, S>(dof, iv, end));
          leave(F, place);
        });
      });
    });
  } else {
    for (int first = 0; first < n; first += width) {
      ForcesAbreast<Wide, Forces> forces(recursion.d.dof_force, first, n);
      order.climb(first, std::min(first + width, n), [&]<class Joint>(auto&& each) {
        along.template operator()<Joint>([&](auto&& visit) {
          Forces<Wide> F = forces.get();
          if (each([&](int i, int iv) { visit(F, i, iv, Part<Wide, S>(first, iv, order.dofEnd(i))); })) forces.leave(F);
        });
      });
    }
  }
}

/// The columns of all subtrees on their way to the root, of U, lever and forces: s . U into d.by_a; what U and lever say of the variations of the
/// joints that they reach below the diagonals of by_q and by_v; s . forces right of these, but not within joints.
template <class Wide, class R, class S>
void pathSweep(const R& recursion, DerivativeWorkspace<S>& d, const PathMatrix<S>& by_q, const PathMatrix<S>& by_v) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // Copies: what packs are stored into might be anything, even the struct that says where.
    const PathMatrix<S> a = d.by_a, q = by_q, v = by_v;
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    const Vec3<T>*const levers = order.w.r, *const lever_rates = recursion.d.shift_rate;
    each([&](DofForces<Wide>& F, int i, int iv, const Part<Wide, S>& part) {
      const Force<Wide>& U = F.by_a;
      const auto enter = [&](int k, const auto& column, const Wide& below_q, const Wide& below_v) {
        a.enterSymmetric(part, iv + k, column.along(U));
        q.enterBelow(part, iv + k, below_q);
        v.enterBelow(part, iv + k, below_v);
        q.enterRight(part, iv + k, iv + Joint::nv, column.along(F.by_q));
        v.enterRight(part, iv + k, iv + Joint::nv, column.along(F.by_v));
      };
      if constexpr (Joint::is_free) {
        // Nothing moves before a flying root: what it makes of its own columns has no more than these.
        if (order.isRoot(i)) {
          for (int k = 0; k < 3; ++k) {
            const DofVariation<T>&slide = variations[iv + k], &turn = variations[iv + 3 + k];
            const Vec3<Wide> by_turn = cast<Wide>(turn.rate.linear), turn_rate = cast<Wide>(turn.rate.angular);
            enter(k, UnitColumn<T>{k}, Wide(0), dot(cast<Wide>(slide.rate.linear), U.linear));
            enter(3 + k, UnitColumn<T>{3 + k}, dot(cast<Wide>(turn.acceleration.linear), U.linear),
                  dot(by_turn, U.linear) + dot(turn_rate, U.angular) + F.lever[k]);
          }
          return;
        }
      }
      for (int k = 0; k < Joint::nv; ++k) {
        const Column<Joint, T> column{dofs[iv + k].S_};
        const DofVariation<T>& change = variations[iv + k];
        Wide below_q = dot(cast<Wide>(change.acceleration.linear), U.linear) + dot(cast<Wide>(change.acceleration.angular), U.angular),
             below_v = dot(cast<Wide>(change.rate.angular), U.angular);
        if constexpr (Joint::has_linear) below_v += dot(cast<Wide>(change.rate.linear), U.linear);
        if constexpr (Joint::has_angular) {
          below_q += dot(cast<Wide>(change.velocity.angular), F.lever);
          below_v += dot(cast<Wide>(column.s.angular), F.lever);
        }
        enter(k, column, below_q, below_v);
      }
      if (order.isRoot(i)) return;
      const Vec3<Wide> r = part.inside() * cast<Wide>(levers[i]), rate = part.inside() * cast<Wide>(T(2) * lever_rates[i]);
      F.lever += cross(rate, U.linear);
      for (Force<Wide>* force : {&F.by_a, &F.by_q, &F.by_v}) force->angular += cross(r, force->linear);
    });
  });
}

/// L: the force columns by_a on their way to the root.
template <class Wide, class R, class S>
void factorsSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  forcesToRoot<Force, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    const Rows<S> L = d.factors.L;
    const auto* const levers = order.w.r;
    each([&](Force<Wide>& F, int i, int iv, const Part<Wide, S>& part) {
      withColumns<Joint>(order, order.w, i, iv, [&](const auto& column) {
        for (int k = 0; k < Joint::nv; ++k) part.store(column(k).along(F), L[iv + k]);
      });
      if (!order.isRoot(i)) F.angular += cross(part.inside() * cast<Wide>(levers[i]), F.linear);
    });
  });
}

}  // namespace dyn::kernels
