// SPDX-License-Identifier: BSD-2-Clause
// Matrices with entries for two degrees of freedom on one root path. The forces of neighbouring degrees of freedom go to the root together, in
// registers.
#pragma once

#include "kernels/derivative/path_entries.hpp"
#include "kernels/derivative/recursion.hpp"

#include <utility>

namespace dyn::kernels {

/// holding: the joints on the root path do not move. projecting_out: they respond to the forces and hand over the rest.
enum class Climbing { holding, projecting_out };

/// The forces of the neighbouring degrees of freedom from `first` on, one in each lane of Wide. Lanes past the n-th repeat the last one. Vectors
/// begin four packs apart, as they do in registers.
template <class Wide, template <class> class Forces>
class ForcePack {
 public:
  ForcePack(const DofForces<Vectored>* forces, int first, int n) {
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
  /// Stores the parts that a step changes. Linear parts change only where joints are projected out.
  template <Climbing climbing>
  void leave(const Force<Wide>& f, int i = 0) {
    if constexpr (climbing == Climbing::projecting_out) put(i, f.linear);
    put(i + 1, f.angular);
  }
  template <Climbing climbing>
  void leave(const DofForces<Wide>& f) {
    leave<climbing>(f.by_a);
    put(2, f.offset);
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

/// Takes the forces of neighbouring degrees of freedom, one in each lane of Wide, along their root paths. Calls along.operator()<Joint>(each) for
/// joints of one shape; each(visit) calls visit(F, i, idx_v, part, own, moves) for the bodies of these joints, children first. visit must move F, the
/// forces, to the parent's origin if that is elsewhere (`moves`). `part`: which of the neighbours are in the subtree of body i. `own`: the forces of
/// the joint's own degrees of freedom as they began.
template <template <class> class Forces, Climbing climbing, class Wide, class S, class R, class Along>
void forcesToRoot(const R& recursion, Along&& along) {
  constexpr int width = Part<Wide, S>::width;
  const auto& order = recursion.order;
  const int n = order.m.nvx;
  const auto movesAt = [&](int i) { return !order.isRoot(i) && order.hasOffset(i); };
  if constexpr (std::is_same_v<typename R::Scalar, Wide>) {
    // The numbers in memory have Wide's lanes already: each joint visits its subtree's degrees of freedom one after the other.
    order.backward(passing(), [&]<class Joint>(const Joint&, int i, int iv) {
      along.template operator()<Joint>([&](auto&& visit) {
        const int end = order.dofEnd(i);
        auto* const forces = recursion.d.dof_force;
        decltype(ownOf(std::declval<Forces<Wide>>())) own[most_nv<Joint>];
        if constexpr (climbing == Climbing::projecting_out)
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
      ForcePack<Wide, Forces> forces(recursion.d.dof_force, first, n);
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
/// project_out for axis k of a floating base, only for the axes before k, which are still to be eliminated.
template <class Wide, class T>
void projectOutBefore(int k, Force<Wide>& F, const Force<T>& row, const Wide& u) {
#pragma GCC unroll 6
  for (int axis = 0; axis < k; ++axis) axisOf(F, axis) -= u * cast<Wide>(axis < 3 ? row.linear : row.angular)[axis % 3];
}

/// (12) of rnea_derivatives.hpp: the entries by q and by v for a degree of freedom that by_a (U) and `offset` meet.
template <class Joint, class T, class Wide>
LowerEntries<Wide> below(const DofVariation<T>& change, const Motion<T>& column, const Force<Wide>& U, const Vec3<Wide>& offset) {
  LowerEntries<Wide> x{dot(cast<Wide>(change.acceleration.linear), U.linear) + dot(cast<Wide>(change.acceleration.angular), U.angular),
                       dot(cast<Wide>(change.rate.angular), U.angular)};
  if constexpr (Joint::has_linear) x.v += dot(cast<Wide>(change.rate.linear), U.linear);
  if constexpr (Joint::has_angular) {
    x.q += dot(cast<Wide>(change.velocity.angular), offset);
    x.v += dot(cast<Wide>(column.angular), offset);
  }
  return x;
}
/// The same for the k-th degree of freedom of a floating base, whose variations begin at `changes`. Its parent, the world, is at rest.
template <class T, class Wide>
LowerEntries<Wide> belowFloatingBase(int k, const DofVariation<T>* changes, const Force<Wide>& U, const Vec3<Wide>& offset) {
  const DofVariation<T>& change = changes[k];
  if (k < 3) return {Wide(0), dot(cast<Wide>(change.rate.linear), U.linear)};
  return {dot(cast<Wide>(change.acceleration.linear), U.linear),
          dot(cast<Wide>(change.rate.linear), U.linear) + dot(cast<Wide>(change.rate.angular), U.angular) + offset[k - 3]};
}

// The sweeps below treat the forces of a degree of freedom one after the other, because all at once do not fit into registers.

/// Moves forces from body i's origin to its parent's.
template <class Wide, class Part, class T>
class ToParent {
 public:
  template <class R>
  ToParent(const R& recursion, const Part& part, int i) : part_(part), offset_(recursion.order.w.r[i]), rate_(recursion.d.shift_rate[i]) {}
  void operator()(Force<Wide>& f) const { addCross(f.angular, part_.inside(cast<Wide>(offset_)), f.linear); }
  /// Moves U, and its offset with it.
  void operator()(Force<Wide>& U, Vec3<Wide>& offset) const {
    addCross(offset, part_.inside(cast<Wide>(T(2) * rate_)), U.linear);
    (*this)(U);
  }

 private:
  const Part& part_;
  const Vec3<T>&offset_, &rate_;
};

/// (12) to (14) of rnea_derivatives.hpp: takes the forces of all degrees of freedom to the root. S . by_a goes to d.by_a, (12) to the lower entries
/// of d.by_q and d.by_v, (13) to their upper entries, which are not used within joints.
template <class Wide, class R, class S>
void pathSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::holding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // A copy: the compiler must assume that stores of packs may change anything, even the struct that holds the pointers.
    const PathEntries<S> path(d);
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&]<class P>(DofForces<Wide>& F, int i, int iv, const P& part, const auto*, const bool moves) {
      const auto entries = path.at(order.m, part, iv);
      const ToParent<Wide, P, T> toParent(recursion, part, i);
      const Force<Wide> U = F.by_a;
      const Vec3<Wide> offset = F.offset;
      const auto enter = [&](int k, const auto& column, const LowerEntries<Wide>& x) {
        entries.inertia(k, column.along(U));
        entries.below(k, x);
      };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
          if constexpr (in_pairs<S>) {
            // The pairs of other joints read the remaining entries from the forces themselves.
            if (part.beyond(iv + 6)) {
              for (int k = 0; k < 3; ++k) entries.lowerByV(k, belowFloatingBase(k, variations + iv, U, offset).v);
              for (int k = 3; k < 6; ++k) entries.below(k, belowFloatingBase(k, variations + iv, U, offset));
              return;
            }
          }
          const auto columnOf = [](int k) { return UnitColumn<T>{k}; };
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) enter(k, columnOf(k), belowFloatingBase(k, variations + iv, U, offset));
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) entries.upperByQ(k, part.inside(columnOf(k).along(F.by_q)));
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) entries.upperByV(k, part.inside(columnOf(k).along(F.by_v)));
          return;
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].column}; };
      for (int k = 0; k < nvOf<Joint>(order, i); ++k) enter(k, columnOf(k), below<Joint>(variations[iv + k], columnOf(k).s, U, offset));
      if (moves) {
        Force<Wide> moved = U;
        Vec3<Wide> moved_offset = offset;
        toParent(moved, moved_offset);
        F.by_a.angular = moved.angular;
        F.offset = moved_offset;
      }
      const auto right = [&](Force<Wide>& force, auto&& enterUpper) {
        Force<Wide> f = force;
        const int nv = nvOf<Joint>(order, i);
#pragma GCC unroll 6
        for (int k = 0; k < nv; ++k) enterUpper(k, part.inside(columnOf(k).along(f)));
        if (moves) {
          toParent(f);
          force.angular = f.angular;
        }
      };
      right(F.by_q, [&](int k, const Wide& x) { entries.upperByQ(k, x); });
      right(F.by_v, [&](int k, const Wide& x) { entries.upperByV(k, x); });
    });
  });
}

/// Stores row k of U: `along`, the forces projected on degree of freedom k, for the degrees of freedom after k, and -1 on the diagonal. Returns the
/// row without the diagonal.
template <class Part, class Wide, class S>
Wide enterProjection(const Part& part, int k, const Wide& along, S* row) {
  const Wide u = part.since(k + 1, along);
  part.store(u - part.at(k), row);
  return u;
}
/// (3) of minverse.hpp: writes U by taking the force columns by_a to the root.
template <class Wide, class R, class S>
void factorsSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<Force, Climbing::projecting_out, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    const Rows<S> U = d.factors.U;
    const DofFactor<T>* const dofs = order.w.dof;
    each([&]<class P>(Force<Wide>& force, int i, int iv, const P& part, const auto* own, const bool moves) {
      Force<Wide> F = force;
      const auto projection = [&](int k, const auto& column) { return enterProjection(part, iv + k, column.along(F), U[iv + k]); };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
#pragma GCC unroll 6
          for (int k = 5; k >= 0; --k) projectOutBefore(k, F, rowOf(own[k]), projection(k, UnitColumn<T>{k}));
          return;
        }
      }
      for (int k = nvOf<Joint>(order, i) - 1; k >= 0; --k) project_out(F, rowOf(own[k]), projection(k, Column<Joint, T>{dofs[iv + k].column}));
      if (moves) ToParent<Wide, P, T>(recursion, part, i)(F);
      force = F;
    });
  });
}
/// (9) of aba_derivatives.hpp, and the damping in (10): writes U and takes the other forces of the columns to the root, too. Their projections on
/// each joint go to the upper entries of by_q and by_v. The lower entries come from U and offset, after the joint that they meet is projected out.
template <class Wide, class R, class S>
void articulatedSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::projecting_out, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // Copies, for the reason given in pathSweep.
    const Rows<S> factors = d.factors.U;
    const PathEntries<S> path(d);
    const S* const damping = d.damping;
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&]<class P>(DofForces<Wide>& F, int i, int iv, const P& part, const auto* own, const bool moves) {
      const ToParent<Wide, P, T> toParent(recursion, part, i);
      const auto entries = path.at(order.m, part, iv);
      // Returns the rest of a force. leaves(k, f, x) subtracts from f the response of the joint, x along its k-th degree of freedom.
      const auto projectOut = [&](Force<Wide> f, const auto& columnOf, auto&& leaves, auto&& enterProjections) {
        const int last = nvOf<Joint>(order, i) - 1;
#pragma GCC unroll 6
        for (int k = last; k >= 0; --k) {
          const Wide x = part.since(iv + last + 1, columnOf(k).along(f));
          enterProjections(k, x);
          leaves(k, f, x);
        }
        return f;
      };
      const auto projectionByQ = [&](int k, const Wide& x) { entries.projectionByQ(k, x); };
      // Damping turns a change of velocity into a torque, whose projections on the joints of the root path are in U.
      const auto projectionByV = [&](int k, const Wide& x) {
        entries.projectionByV(k, damping ? x - loadPack<Wide>(damping + part.first()) * loadPack<Wide>(factors[iv + k] + part.first()) : x);
      };
      Force<Wide> U = F.by_a;
      Vec3<Wide> offset = F.offset;
      const auto projection = [&](int k, const auto& column) {
        const Wide u = enterProjection(part, iv + k, column.along(U), factors[iv + k]);
        offset -= u * cast<Wide>(own[k].offset);
        return u;
      };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
          const bool plain = isPlainFloatingBase<Joint>(order, i);
          const auto columnOf = [](int k) { return UnitColumn<T>{k}; };
#pragma GCC unroll 6
          for (int k = 5; k >= 0; --k) {
            const Wide u = projection(k, columnOf(k));
            if (!plain) {
              project_out(U, rowOf(own[k]), u);
            } else {
              projectOutBefore(k, U, rowOf(own[k]), u);
              axisOf(U, k) -= u;
            }
          }
          // A plain floating base absorbs the forces of all other joints completely.
          const bool others = part.beyond(iv + 6), nothing = plain && others;
          const auto enterLower = [&](auto&& enter) {
#pragma GCC unroll 6
            for (int k = 0; k < 6; ++k) enter(k, belowFloatingBase(k, variations + iv, U, offset));
          };
          if (in_pairs<S> && others) {
            // The layout is that of DofForces.
            if (nothing) {
              F.by_a.angular = offset;
            } else {
              enterLower([&](int k, const LowerEntries<Wide>& x) {
                axisOf(F.by_a, k) = x.v;
                if (k >= 3) F.offset[k - 3] = x.q;
              });
            }
          } else if (nothing) {
#pragma GCC unroll 6
            for (int k = 0; k < 6; ++k) entries.below(k, {Wide(0), k < 3 ? Wide(0) : offset[k - 3]});
          } else {
            enterLower([&](int k, const LowerEntries<Wide>& x) { entries.below(k, x); });
          }
          const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { projectOutBefore(k, f, rowOf(own[k]), x); };
          projectOut(F.by_q, columnOf, leaves, projectionByQ);
          projectOut(F.by_v, columnOf, leaves, projectionByV);
          return;
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].column}; };
      for (int k = nvOf<Joint>(order, i) - 1; k >= 0; --k) project_out(U, rowOf(own[k]), projection(k, columnOf(k)));
      for (int k = 0; k < nvOf<Joint>(order, i); ++k) entries.below(k, below<Joint>(variations[iv + k], columnOf(k).s, U, offset));
      if (moves) toParent(U, offset);
      F.by_a = U;
      F.offset = offset;
      const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { project_out(f, rowOf(own[k]), x); };
      const auto climb = [&](Force<Wide>& force, auto&& enterProjections) {
        Force<Wide> f = projectOut(force, columnOf, leaves, enterProjections);
        if (moves) toParent(f);
        force = f;
      };
      climb(F.by_q, projectionByQ);
      climb(F.by_v, projectionByV);
    });
  });
}

}  // namespace dyn::kernels
