// SPDX-License-Identifier: BSD-2-Clause
// Forces of degrees of freedom that go from their joints to the root.
#pragma once

#include <dyn/scalar/select.hpp>
#include <dyn/spatial/force.hpp>

namespace dyn::kernels {

/// The forces that a degree of freedom's motion and its variation cause, about its joint's origin, and on the root path about the origins of the
/// joints there. At a floating base, where they end, aba for states in packs replaces them by the lower entries with the base's columns: by_a holds
/// those by v, `offset` those by q of the three rotations. At a plain floating base by_a.angular holds those by v of the rotations; the others are
/// zero.
template <class S>
struct DofForces {
  Force<S> by_a;   ///< I S; in aba IA S / D, IA the articulated inertia
  Vec3<S> offset;  ///< offset . x: the projection on S of the Coriolis force of a rotation rate x; in aba over D
  Force<S> by_q, by_v;
};

/// The part of a degree of freedom's forces that projecting out other forces needs.
template <class S>
struct OwnForces {
  Force<S> by_a;
  Vec3<S> offset;
};
template <class S>
OwnForces<S> ownOf(const DofForces<S>& f) {
  return {f.by_a, f.offset};
}
template <class S>
Force<S> ownOf(const Force<S>& f) {
  return f;
}

/// The force column of a degree of freedom, IA S / D, by which it is projected out.
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
/// Subtracts from F the response of a joint with this force column, which moves by u.
template <class Wide, class T>
void project_out(Force<Wide>& F, const Force<T>& row, const Wide& u) {
  F.linear -= u * cast<Wide>(row.linear);
  F.angular -= u * cast<Wide>(row.angular);
}
/// Entries below the diagonal, by q and by v: forces times variations.
template <class S>
struct LowerEntries {
  S q, v;
};

}  // namespace dyn::kernels
