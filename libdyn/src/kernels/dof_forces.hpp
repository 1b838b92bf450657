// Forces of degrees of freedom that climb from their joints to the root.
#pragma once

#include <dyn/scalar/select.hpp>
#include <dyn/spatial/force.hpp>

namespace dyn::kernels {

/// Forces about its joint's origin that a degree of freedom's motion, and its variation, bring; on their way to the root, about the origins there. At
/// a flying root, where they end, aba of states in packs leaves in their place what its columns make of them below the diagonals: by v that of each
/// in by_a, by q that of its turning in lever; of a bare root's only by v that of its turning, as it makes nothing else of them.
template <class S>
struct DofForces {
  Force<S> by_a;  ///< I s; in aba the articulated inertia's, / pivot
  Vec3<S> lever;  ///< of by_a's on turning rates
  Force<S> by_q, by_v;
};

/// What others that climb past a degree of freedom take of its forces.
template <class S>
struct OwnForces {
  Force<S> by_a;
  Vec3<S> lever;
};
template <class S>
OwnForces<S> ownOf(const DofForces<S>& f) {
  return {f.by_a, f.lever};
}
template <class S>
Force<S> ownOf(const Force<S>& f) {
  return f;
}

/// The force among a degree of freedom's, which joints give way to as rows of the factors say.
template <class S>
const Force<S>& rowOf(const Force<S>& f) {
  return f;
}
template <class S>
const Force<S>& rowOf(const DofForces<S>& f) {
  return f.by_a;
}
template <class S>
const Force<S>& rowOf(const OwnForces<S>& f) {
  return f.by_a;
}
/// What a joint that moves by u along the degree of freedom of this row leaves of a force.
template <class Wide, class T>
void yield(Force<Wide>& F, const Force<T>& row, const Wide& u) {
  F.linear -= u * cast<Wide>(row.linear);
  F.angular -= u * cast<Wide>(row.angular);
}
/// What variations make of forces, by q and by v.
template <class S>
struct Below {
  S q, v;
};

}  // namespace dyn::kernels
