// SPDX-License-Identifier: BSD-2-Clause
// Spatial motions (twists): velocities and accelerations of a body, linear part first.
#pragma once

#include <dyn/spatial/vector3.hpp>

namespace dyn {

/// Spatial velocity or acceleration of a body in some frame, zero by default.
template <class S>
struct Motion {
  Vec3<S> linear{},  ///< velocity or acceleration of the body's point at the frame's origin [m/s or m/s^2]
      angular{};     ///< angular velocity or acceleration [rad/s or rad/s^2]

  /// Computes sums, differences and multiples, component by component.
  /// @{
  friend Motion operator+(const Motion& a, const Motion& b) { return {a.linear + b.linear, a.angular + b.angular}; }
  friend Motion operator-(const Motion& a, const Motion& b) { return {a.linear - b.linear, a.angular - b.angular}; }
  friend Motion operator*(const S& s, const Motion& a) { return {s * a.linear, s * a.angular}; }
  Motion& operator+=(const Motion& b) { return *this = *this + b; }
  Motion& operator-=(const Motion& b) { return *this = *this - b; }
  /// @}

  /// Returns v x m for this motion v: the derivative of a motion m fixed in a frame that moves with v (Featherstone 2008, eq. 2.31).
  Motion cross(const Motion& m) const { return {dyn::cross(angular, m.linear) + dyn::cross(linear, m.angular), dyn::cross(angular, m.angular)}; }
};

}  // namespace dyn
