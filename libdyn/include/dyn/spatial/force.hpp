// SPDX-License-Identifier: BSD-2-Clause
// Spatial forces (wrenches) and momenta, linear part first.
#pragma once

#include <dyn/spatial/motion.hpp>

namespace dyn {

/// Spatial force or momentum in some frame, zero by default.
template <class S>
struct Force {
  Vec3<S> linear{},  ///< force [N] or linear momentum [kg m/s]
      angular{};     ///< moment [N m] or angular momentum [kg m^2/s] about the frame's origin

  /// Computes sums, differences and multiples, component by component.
  /// @{
  friend Force operator+(const Force& a, const Force& b) { return {a.linear + b.linear, a.angular + b.angular}; }
  friend Force operator-(const Force& a, const Force& b) { return {a.linear - b.linear, a.angular - b.angular}; }
  friend Force operator*(const S& s, const Force& a) { return {s * a.linear, s * a.angular}; }
  Force& operator+=(const Force& b) { return *this = *this + b; }
  Force& operator-=(const Force& b) { return *this = *this - b; }
  /// @}
};

/// Returns the power [W] of a force along a velocity. Both are in the same frame.
template <class S>
S dot(const Motion<S>& m, const Force<S>& f) {
  return dot(m.linear, f.linear) + dot(m.angular, f.angular);
}

/// Returns v x* f, the derivative of a force f fixed in a frame that moves with v (Featherstone 2008, eq. 2.32).
template <class S>
Force<S> crossStar(const Motion<S>& v, const Force<S>& f) {
  return {cross(v.angular, f.linear), cross(v.angular, f.angular) + cross(v.linear, f.linear)};
}

}  // namespace dyn
