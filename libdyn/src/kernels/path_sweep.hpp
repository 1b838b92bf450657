// Matrices with entries for two degrees of freedom on one path to the root: forces of neighbours climb together, and stay in registers on their way.
#pragma once

#include "kernels/path_entries.hpp"
#include "kernels/recursion.hpp"

#include <utility>

namespace dyn::kernels {

/// Joints on the way to the root hold, or they yield to the forces and hand over what is left.
enum class Climbing { holding, yielding };

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
  /// What climbing changes: but for what joints give way to, linear parts are the same wherever forces are.
  template <Climbing climbing>
  void leave(const Force<Wide>& f, int i = 0) {
    if constexpr (climbing == Climbing::yielding) put(i, f.linear);
    put(i + 1, f.angular);
  }
  template <Climbing climbing>
  void leave(const DofForces<Wide>& f) {
    leave<climbing>(f.by_a);
    put(2, f.lever);
    leave<climbing>(f.by_q, 3);
    leave<climbing>(f.by_v, 5);
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

/// Neighbouring degrees of freedom, as many as Wide has lanes, on their paths to the root: calls along.operator()<Joint>(each) for joints of one
/// shape, and each(visit) calls visit(F, i, idx_v, part, own, moves) for these joints' bodies, children first: F, the neighbours' forces, are to be
/// moved to the parent's origin, if that is elsewhere (`moves`), `part` is what of the neighbours is in the subtree of body i, and `own` has what the
/// joint's own forces began with.
template <template <class> class Forces, Climbing climbing, class Wide, class S, class R, class Along>
void forcesToRoot(const R& recursion, Along&& along) {
  constexpr int width = Part<Wide, S>::width;
  const auto& order = recursion.order;
  const int n = order.m.nvx;
  const auto movesAt = [&](int i) { return !order.isRoot(i) && order.hasLever(i); };
  if constexpr (std::is_same_v<typename R::Scalar, Wide>) {
    // They are in lanes where they are: all of a subtree's one after the other at each joint.
    order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
      along.template operator()<Joint>([&](auto&& visit) {
        const int end = order.dofEnd(i);
        auto* const forces = recursion.d.dof_force;
        decltype(ownOf(std::declval<Forces<Wide>>())) own[most_nv<Joint>];
        if constexpr (climbing == Climbing::yielding)
          for (int k = 0; k < nvOf<Joint>(order, i); ++k) own[k] = ownOf(reinterpret_cast<const Forces<Wide>&>(forces[iv + k]));
        const bool moves = movesAt(i);
        const auto at = [&](int dof, const auto& part) { visit(reinterpret_cast<Forces<Wide>&>(forces[dof]), i, iv, part, own, moves); };
        const int end_own = iv + nvOf<Joint>(order, i);
        order.eachDof(iv, end_own, [&](int dof) { at(dof, Part<Wide, S>(dof, iv, end)); });
        order.eachDof(end_own, end, [&](int dof) { at(dof, Descendant<S>(dof)); });
      });
    });
  } else {
    for (int first = 0; first < n; first += width) {
      ForcesAbreast<Wide, Forces> forces(recursion.d.dof_force, first, n);
      order.climb(first, std::min(first + width, n), [&]<class Joint>(auto&& each) {
        along.template operator()<Joint>([&](auto&& visit) {
          Forces<Wide> F = forces.get();
          const auto at = [&](int i, int iv) { visit(F, i, iv, Part<Wide, S>(first, iv, order.dofEnd(i)), recursion.d.dof_force + iv, movesAt(i)); };
          if (each(at)) forces.template leave<climbing>(F);
        });
      });
    }
  }
}

template <class S>
S& axisOf(Force<S>& F, int axis) {
  return axis < 3 ? F.linear[axis] : F.angular[axis - 3];
}
/// Of what a flying root leaves, what its axes before the k-th are to give way to.
template <class Wide, class T>
void yieldBefore(int k, Force<Wide>& F, const Force<T>& row, const Wide& u) {
#pragma GCC unroll 6
  for (int axis = 0; axis < k; ++axis) axisOf(F, axis) -= u * cast<Wide>(axis < 3 ? row.linear : row.angular)[axis % 3];
}

/// Of the variation of a degree of freedom on the way of U, by_a, and its lever.
template <class Joint, class T, class Wide>
Below<Wide> below(const DofVariation<T>& change, const Motion<T>& column, const Force<Wide>& U, const Vec3<Wide>& lever) {
  Below<Wide> x{dot(cast<Wide>(change.acceleration.linear), U.linear) + dot(cast<Wide>(change.acceleration.angular), U.angular),
                dot(cast<Wide>(change.rate.angular), U.angular)};
  if constexpr (Joint::has_linear) x.v += dot(cast<Wide>(change.rate.linear), U.linear);
  if constexpr (Joint::has_angular) {
    x.q += dot(cast<Wide>(change.velocity.angular), lever);
    x.v += dot(cast<Wide>(column.angular), lever);
  }
  return x;
}
/// The same of a flying root's k-th, whose variations are from `changes` on. Nothing moves before it.
template <class T, class Wide>
Below<Wide> belowFlyingRoot(int k, const DofVariation<T>* changes, const Force<Wide>& U, const Vec3<Wide>& lever) {
  const DofVariation<T>& change = changes[k];
  if (k < 3) return {Wide(0), dot(cast<Wide>(change.rate.linear), U.linear)};
  return {dot(cast<Wide>(change.acceleration.linear), U.linear),
          dot(cast<Wide>(change.rate.linear), U.linear) + dot(cast<Wide>(change.rate.angular), U.angular) + lever[k - 3]};
}

// Below, one of the forces of degrees of freedom goes after the other: all at once they do not fit into registers.

/// From body i's origin to its parent's.
template <class Wide, class Part, class T>
class ToParent {
 public:
  template <class R>
  ToParent(const R& recursion, const Part& part, int i) : part_(part), lever_(recursion.order.w.r[i]), rate_(recursion.d.shift_rate[i]) {}
  void operator()(Force<Wide>& f) const { addCross(f.angular, part_.inside(cast<Wide>(lever_)), f.linear); }
  /// U, and its lever with it.
  void operator()(Force<Wide>& U, Vec3<Wide>& lever) const {
    addCross(lever, part_.inside(cast<Wide>(T(2) * rate_)), U.linear);
    (*this)(U);
  }

 private:
  const Part& part_;
  const Vec3<T>&lever_, &rate_;
};

/// The columns of all subtrees on their way to the root, of U, lever and forces: s . U into d.by_a; what U and lever say of the variations of the
/// joints that they reach below the diagonals of by_q and by_v; s . forces right of these, but not within joints.
template <class Wide, class R, class S>
void pathSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::holding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // A copy: what packs are stored into might be anything, even the struct that says where.
    const PathEntries<S> path(d);
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&]<class P>(DofForces<Wide>& F, int i, int iv, const P& part, const auto*, const bool moves) {
      const auto entries = path.at(order.m, part, iv);
      const ToParent<Wide, P, T> toParent(recursion, part, i);
      const Force<Wide> U = F.by_a;
      const Vec3<Wide> lever = F.lever;
      const auto enter = [&](int k, const auto& column, const Below<Wide>& x) {
        entries.inertia(k, column.along(U));
        entries.below(k, x);
      };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
          if constexpr (in_pairs<S>) {
            // The others' pairs find the rest where it is.
            if (part.beyond(iv + 6)) {
              for (int k = 0; k < 3; ++k) entries.belowByV(k, belowFlyingRoot(k, variations + iv, U, lever).v);
              for (int k = 3; k < 6; ++k) entries.below(k, belowFlyingRoot(k, variations + iv, U, lever));
              return;
            }
          }
          const auto columnOf = [](int k) { return UnitColumn<T>{k}; };
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) enter(k, columnOf(k), belowFlyingRoot(k, variations + iv, U, lever));
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) entries.rightByQ(k, part.inside(columnOf(k).along(F.by_q)));
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) entries.rightByV(k, part.inside(columnOf(k).along(F.by_v)));
          return;
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].S_}; };
      for (int k = 0; k < nvOf<Joint>(order, i); ++k) enter(k, columnOf(k), below<Joint>(variations[iv + k], columnOf(k).s, U, lever));
      if (moves) {
        Force<Wide> moved = U;
        Vec3<Wide> moved_lever = lever;
        toParent(moved, moved_lever);
        F.by_a.angular = moved.angular;
        F.lever = moved_lever;
      }
      const auto right = [&](Force<Wide>& force, auto&& enterRight) {
        Force<Wide> f = force;
        const int nv = nvOf<Joint>(order, i);
#pragma GCC unroll 6
        for (int k = 0; k < nv; ++k) enterRight(k, part.inside(columnOf(k).along(f)));
        if (moves) {
          toParent(f);
          force.angular = f.angular;
        }
      };
      right(F.by_q, [&](int k, const Wide& x) { entries.rightByQ(k, x); });
      right(F.by_v, [&](int k, const Wide& x) { entries.rightByV(k, x); });
    });
  });
}

/// What degree of freedom k takes of the forces along it, which is row k of U but for the diagonal.
template <class Part, class Wide, class S>
Wide enterShare(const Part& part, int k, const Wide& along, S* row) {
  const Wide u = part.since(k + 1, along);
  part.store(u - part.at(k), row);
  return u;
}
/// U: the force columns by_a on their way to the root.
template <class Wide, class R, class S>
void factorsSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<Force, Climbing::yielding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    const Rows<S> U = d.factors.U;
    const DofFactor<T>* const dofs = order.w.dof;
    each([&]<class P>(Force<Wide>& force, int i, int iv, const P& part, const auto* own, const bool moves) {
      Force<Wide> F = force;
      const auto share = [&](int k, const auto& column) { return enterShare(part, iv + k, column.along(F), U[iv + k]); };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
#pragma GCC unroll 6
          for (int k = 5; k >= 0; --k) yieldBefore(k, F, rowOf(own[k]), share(k, UnitColumn<T>{k}));
          return;
        }
      }
      for (int k = nvOf<Joint>(order, i) - 1; k >= 0; --k) yield(F, rowOf(own[k]), share(k, Column<Joint, T>{dofs[iv + k].S_}));
      if (moves) ToParent<Wide, P, T>(recursion, part, i)(F);
      force = F;
    });
  });
}
/// The same, and of the columns' other forces: what they leave along each degree of freedom on their way, right of joints' own in by_q and
/// by_v, there with what damping adds; and what variations of the joints that by_a and lever reach make of these, when all up to there have given
/// way, below the diagonals.
template <class Wide, class R, class S>
void articulatedSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::yielding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // Copies, as above.
    const Rows<S> factors = d.factors.U;
    const PathEntries<S> path(d);
    const S* const damping = d.damping;
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&]<class P>(DofForces<Wide>& F, int i, int iv, const P& part, const auto* own, const bool moves) {
      const ToParent<Wide, P, T> toParent(recursion, part, i);
      const auto entries = path.at(order.m, part, iv);
      // What is left of a force; leaves(k, f, x): where the joint moves by x along its k-th degree of freedom.
      const auto giveWay = [&](Force<Wide> f, const auto& columnOf, auto&& leaves, auto&& enterShares) {
        const int last = nvOf<Joint>(order, i) - 1;
#pragma GCC unroll 6
        for (int k = last; k >= 0; --k) {
          const Wide x = part.since(iv + last + 1, columnOf(k).along(f));
          enterShares(k, x);
          leaves(k, f, x);
        }
        return f;
      };
      const auto shareByQ = [&](int k, const Wide& x) { entries.shareByQ(k, x); };
      // Damping answers velocities with torques, of which joints on the way get what U says.
      const auto shareByV = [&](int k, const Wide& x) {
        entries.shareByV(k, damping ? x - loadPack<Wide>(damping + part.first()) * loadPack<Wide>(factors[iv + k] + part.first()) : x);
      };
      Force<Wide> U = F.by_a;
      Vec3<Wide> lever = F.lever;
      const auto share = [&](int k, const auto& column) {
        const Wide u = enterShare(part, iv + k, column.along(U), factors[iv + k]);
        lever -= u * cast<Wide>(own[k].lever);
        return u;
      };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
          const bool bare = isBareRoot<Joint>(order, i);
          const auto columnOf = [](int k) { return UnitColumn<T>{k}; };
#pragma GCC unroll 6
          for (int k = 5; k >= 0; --k) {
            const Wide u = share(k, columnOf(k));
            if (!bare) {
              yield(U, rowOf(own[k]), u);
            } else {
              yieldBefore(k, U, rowOf(own[k]), u);
              axisOf(U, k) -= u;
            }
          }
          // Of all forces but its own axes', which leave their units, a bare root leaves nothing.
          const bool others = part.beyond(iv + 6), nothing = bare && others;
          const auto enterBelow = [&](auto&& enter) {
#pragma GCC unroll 6
            for (int k = 0; k < 6; ++k) enter(k, belowFlyingRoot(k, variations + iv, U, lever));
          };
          if (in_pairs<S> && others) {
            // As DofForces says.
            if (nothing) {
              F.by_a.angular = lever;
            } else {
              enterBelow([&](int k, const Below<Wide>& x) {
                axisOf(F.by_a, k) = x.v;
                if (k >= 3) F.lever[k - 3] = x.q;
              });
            }
          } else if (nothing) {
#pragma GCC unroll 6
            for (int k = 0; k < 6; ++k) entries.below(k, {Wide(0), k < 3 ? Wide(0) : lever[k - 3]});
          } else {
            enterBelow([&](int k, const Below<Wide>& x) { entries.below(k, x); });
          }
          const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { yieldBefore(k, f, rowOf(own[k]), x); };
          giveWay(F.by_q, columnOf, leaves, shareByQ);
          giveWay(F.by_v, columnOf, leaves, shareByV);
          return;
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].S_}; };
      for (int k = nvOf<Joint>(order, i) - 1; k >= 0; --k) yield(U, rowOf(own[k]), share(k, columnOf(k)));
      for (int k = 0; k < nvOf<Joint>(order, i); ++k) entries.below(k, below<Joint>(variations[iv + k], columnOf(k).s, U, lever));
      if (moves) toParent(U, lever);
      F.by_a = U;
      F.lever = lever;
      const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { yield(f, rowOf(own[k]), x); };
      const auto climb = [&](Force<Wide>& force, auto&& enterShares) {
        Force<Wide> f = giveWay(force, columnOf, leaves, enterShares);
        if (moves) toParent(f);
        force = f;
      };
      climb(F.by_q, shareByQ);
      climb(F.by_v, shareByV);
    });
  });
}

}  // namespace dyn::kernels
