// SPDX-License-Identifier: BSD-2-Clause
// Rigid transforms. aMb maps coordinates in frame b to coordinates in frame a, so inner letters cancel: aMc = aMb * bMc.
#pragma once

#include <dyn/spatial/force.hpp>
#include <dyn/spatial/motion.hpp>

namespace dyn {

/// Pose aMb of frame b in frame a: x_a = R x_b + p. It is the unit transform by default.
template <class S>
struct SE3 {
  Mat3<S> R = Mat3<S>::identity();  ///< rotation; its columns are b's axes in a
  Vec3<S> p{};                      ///< b's origin in a [m]

  /// Returns the composition aMc = aMb bMc.
  friend SE3 operator*(const SE3& a, const SE3& b) { return {a.R * b.R, a.p + a.R * b.p}; }

  /// Returns bMa. R^T is taken for R^-1.
  SE3 inverse() const {
    const Mat3<S> Rt = transpose(R);
    return {Rt, -(Rt * p)};
  }
  /// Maps the coordinates of a point from b to a (act), or back (actInv).
  /// @{
  Vec3<S> act(const Vec3<S>& x) const { return R * x + p; }
  Vec3<S> actInv(const Vec3<S>& x) const { return transposeTimes(R, x - p); }
  /// @}

  /// Maps a motion from b to a by its Plucker transform (Featherstone 2008, eq. 2.21 with the linear part first), or back.
  /// @{
  Motion<S> act(const Motion<S>& m) const {
    const Vec3<S> w = R * m.angular;
    return {R * m.linear + cross(p, w), w};
  }
  Motion<S> actInv(const Motion<S>& m) const { return {transposeTimes(R, m.linear - cross(p, m.angular)), transposeTimes(R, m.angular)}; }
  /// @}
  /// Maps a force from b to a by the dual transform, which keeps the power, or back.
  /// @{
  Force<S> act(const Force<S>& f) const {
    const Vec3<S> l = R * f.linear;
    return {l, R * f.angular + cross(p, l)};
  }
  Force<S> actInv(const Force<S>& f) const { return {transposeTimes(R, f.linear), transposeTimes(R, f.angular - cross(p, f.linear))}; }
  /// @}
};

/// Returns the same pose in another scalar. compile() composes poses in long double and rounds once.
template <class To, class From>
SE3<To> cast(const SE3<From>& X) {
  return {cast<To>(X.R), cast<To>(X.p)};
}

}  // namespace dyn
