// Matrices with entries for two degrees of freedom on one path to the root: forces of neighbours climb together, and stay in registers on their way.
#pragma once

#include "kernels/recursion.hpp"
#include "kernels/subtree.hpp"

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
/// shape, and each(visit) calls visit(F, i, idx_v, part, own) for these joints' bodies, children first: F, the neighbours' forces, are to be moved to
/// the parent's origin, `part` is what of the neighbours is in the subtree of body i, and `own` has what the joint's own forces began with.
template <template <class> class Forces, Climbing climbing, class Wide, class S, class R, class Along>
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
        Forces<Wide> own[Joint::nv];
        if constexpr (climbing == Climbing::yielding)
          for (int k = 0; k < Joint::nv; ++k) own[k] = reinterpret_cast<const Forces<Wide>&>(forces[iv + k]);
        order.eachDof(iv, end, [&](int dof) { visit(reinterpret_cast<Forces<Wide>&>(forces[dof]), i, iv, Part<Wide, S>(dof, iv, end), own); });
      });
    });
  } else {
    for (int first = 0; first < n; first += width) {
      ForcesAbreast<Wide, Forces> forces(recursion.d.dof_force, first, n);
      order.climb(first, std::min(first + width, n), [&]<class Joint>(auto&& each) {
        along.template operator()<Joint>([&](auto&& visit) {
          Forces<Wide> F = forces.get();
          const auto at = [&](int i, int iv) { visit(F, i, iv, Part<Wide, S>(first, iv, order.dofEnd(i)), recursion.d.dof_force + iv); };
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
template <class Wide, class S, class T>
class ToParent {
 public:
  template <class R>
  ToParent(const R& recursion, const Part<Wide, S>& part, int i)
      : part_(part),
        lever_(recursion.order.w.r[i]),
        rate_(recursion.d.shift_rate[i]),
        moves_(!recursion.order.isRoot(i) && recursion.order.hasLever(i)) {}
  void operator()(Force<Wide>& f) const {
    if (moves_) addCross(f.angular, part_.inside(cast<Wide>(lever_)), f.linear);
  }
  /// U, and its lever with it.
  void operator()(Force<Wide>& U, Vec3<Wide>& lever) const {
    if (moves_) addCross(lever, part_.inside(cast<Wide>(T(2) * rate_)), U.linear);
    (*this)(U);
  }

 private:
  const Part<Wide, S>& part_;
  const Vec3<T>&lever_, &rate_;
  bool moves_;
};

/// The columns of all subtrees on their way to the root, of U, lever and forces: s . U into d.by_a; what U and lever say of the variations of the
/// joints that they reach below the diagonals of by_q and by_v; s . forces right of these, but not within joints.
template <class Wide, class R, class S>
void pathSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::holding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // Copies: what packs are stored into might be anything, even the struct that says where.
    const PathMatrix<S> by_a = d.by_a, by_q = d.by_q, by_v = d.by_v;
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&](DofForces<Wide>& F, int i, int iv, const Part<Wide, S>& part, const auto*) {
      const ToParent<Wide, S, T> toParent(recursion, part, i);
      const auto enter = [&](int k, const Wide& a, const Below<Wide>& x) {
        by_a.enterSymmetric(part, iv + k, a);
        by_q.enterBelow(part, iv + k, x.q);
        by_v.enterBelow(part, iv + k, x.v);
      };
      const auto enterRight = [&](const PathMatrix<S>& by, Force<Wide>& force, const auto& columnOf) {
        Force<Wide> f = force;
#pragma GCC unroll 6
        for (int k = 0; k < Joint::nv; ++k) by.enterRight(part, iv + k, iv + Joint::nv, columnOf(k).along(f));
        toParent(f);
        force.angular = f.angular;
      };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
          const auto columnOf = [](int k) { return UnitColumn<T>{k}; };
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k) enter(k, columnOf(k).along(F.by_a), belowFlyingRoot(k, variations + iv, F.by_a, F.lever));
          enterRight(by_q, F.by_q, columnOf);
          return enterRight(by_v, F.by_v, columnOf);
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].S_}; };
      Force<Wide> U = F.by_a;
      Vec3<Wide> lever = F.lever;
      for (int k = 0; k < Joint::nv; ++k) enter(k, columnOf(k).along(U), below<Joint>(variations[iv + k], columnOf(k).s, U, lever));
      toParent(U, lever);
      F.by_a.angular = U.angular;
      F.lever = lever;
      enterRight(by_q, F.by_q, columnOf);
      enterRight(by_v, F.by_v, columnOf);
    });
  });
}

/// What degree of freedom k takes of the forces along it, which is row k of U but for the diagonal.
template <class Wide, class S>
Wide enterShare(const Part<Wide, S>& part, int k, const Wide& along, S* row) {
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
    each([&](Force<Wide>& force, int i, int iv, const Part<Wide, S>& part, const auto* own) {
      Force<Wide> F = force;
      const auto share = [&](int k, const auto& column) { return enterShare(part, iv + k, column.along(F), U[iv + k]); };
      if constexpr (Joint::is_free) {
        if (order.isRoot(i)) {
#pragma GCC unroll 6
          for (int k = 5; k >= 0; --k) yieldBefore(k, F, rowOf(own[k]), share(k, UnitColumn<T>{k}));
          return;
        }
      }
      for (int k = Joint::nv - 1; k >= 0; --k) yield(F, rowOf(own[k]), share(k, Column<Joint, T>{dofs[iv + k].S_}));
      ToParent<Wide, S, T>(recursion, part, i)(F);
      force = F;
    });
  });
}
/// The same, and of the columns' other forces: what they leave along each degree of freedom on their way, right of joints' own in by_q and
/// by_v; and what variations of the joints that by_a and lever reach make of these, when all up to there have given way, below the diagonals.
template <class Wide, class R, class S>
void articulatedSweep(const R& recursion, DerivativeWorkspace<S>& d) {
  const auto& order = recursion.order;
  using T = typename R::Scalar;
  forcesToRoot<DofForces, Climbing::yielding, Wide, S>(recursion, [&]<class Joint>(auto&& each) {
    // Copies, as above.
    const Rows<S> factors = d.factors.U;
    const PathMatrix<S> by_q = d.by_q, by_v = d.by_v;
    const DofFactor<T>* const dofs = order.w.dof;
    const DofVariation<T>* const variations = recursion.d.dof;
    each([&](DofForces<Wide>& F, int i, int iv, const Part<Wide, S>& part, const auto* own) {
      const ToParent<Wide, S, T> toParent(recursion, part, i);
      const auto enter = [&](int k, const Below<Wide>& x) {
        by_q.enterBelow(part, iv + k, x.q);
        by_v.enterBelow(part, iv + k, x.v);
      };
      // leaves(k, f, x): what a joint that moves by x along its k-th degree of freedom leaves of f.
      const auto giveWay = [&](const PathMatrix<S>& by, Force<Wide>& force, const auto& columnOf, auto&& leaves) {
        Force<Wide> f = force;
#pragma GCC unroll 6
        for (int k = Joint::nv - 1; k >= 0; --k) {
          const Wide x = part.since(iv + Joint::nv, columnOf(k).along(f));
          part.store(x, by.right[iv + k]);
          leaves(k, f, x);
        }
        toParent(f);
        force = f;
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
          const bool nothing = bare && part.first() >= iv + 6;
#pragma GCC unroll 6
          for (int k = 0; k < 6; ++k)
            enter(k, nothing ? Below<Wide>{Wide(0), k < 3 ? Wide(0) : lever[k - 3]} : belowFlyingRoot(k, variations + iv, U, lever));
          const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { yieldBefore(k, f, rowOf(own[k]), x); };
          giveWay(by_q, F.by_q, columnOf, leaves);
          return giveWay(by_v, F.by_v, columnOf, leaves);
        }
      }
      const auto columnOf = [&](int k) { return Column<Joint, T>{dofs[iv + k].S_}; };
      for (int k = Joint::nv - 1; k >= 0; --k) yield(U, rowOf(own[k]), share(k, columnOf(k)));
      for (int k = 0; k < Joint::nv; ++k) enter(k, below<Joint>(variations[iv + k], columnOf(k).s, U, lever));
      toParent(U, lever);
      F.by_a = U;
      F.lever = lever;
      const auto leaves = [&](int k, Force<Wide>& f, const Wide& x) { yield(f, rowOf(own[k]), x); };
      giveWay(by_q, F.by_q, columnOf, leaves);
      giveWay(by_v, F.by_v, columnOf, leaves);
    });
  });
}

}  // namespace dyn::kernels
