// SPDX-License-Identifier: BSD-2-Clause
// The forces on a body as linear functions of its inertial parameters (Atkeson, An and Hollerbach 1986).
//
// A body with a unit value of one of its ten parameters, and zero for the others, needs a force for its motion. In the axes of the user's joint, at
// its origin, with the origin's classical acceleration o less gravity, angular velocity w and acceleration dw, that force is for
//
//   (1)  m        linear o
//   (2)  m c      linear A c, angular c x o, with A = dw x + w x w x
//   (3)  I        angular I dw + w x I w
#pragma once

#include "kernels/body/workspace.hpp"

namespace dyn::kernels {

/// Whether the parameters of joint j's body are counted at joint j. Several of the user's joints can belong to one body.
inline bool carriesBody(const CompactImpl& m, int j) {
  const auto body = static_cast<std::size_t>(m.body_of_joint[static_cast<std::size_t>(j)]);
  return m.index[body].joint == j;
}

/// The forces (1) to (3).
class UnitForces {
 public:
  using Vec = Vec3<double>;
  UnitForces(const Vec& origin, const Vec& w, const Vec& dw) : o_(origin) {
    const double xx = w.x * w.x, yy = w.y * w.y, zz = w.z * w.z, xy = w.x * w.y, xz = w.x * w.z, yz = w.y * w.z;
    A_[0] = {-yy - zz, xy + dw.z, xz - dw.y};
    A_[1] = {xy - dw.z, -xx - zz, yz + dw.x};
    A_[2] = {xz + dw.y, yz - dw.x, -xx - yy};
    I_[0] = {dw.x, xz, -xy};
    I_[1] = {dw.y - xz, dw.x + yz, xx - yy};
    I_[2] = {-yz, dw.y, xy};
    I_[3] = {dw.z + xy, zz - xx, dw.x - yz};
    I_[4] = {yy - zz, dw.z - xy, dw.y + xz};
    I_[5] = {yz, -xz, dw.z};
  }

  /// Calls put(k, power) with the power of the force of parameter k along a motion, or along a pack of motions.
  template <class S, class Put>
  void along(const Motion<S>& s, Put&& put) const {
    const Vec3<S>&v = s.linear, &u = s.angular;
    put(0, v.x * S(o_.x) + v.y * S(o_.y) + v.z * S(o_.z));
    const Vec3<S> moment{u.z * S(o_.y) - u.y * S(o_.z), u.x * S(o_.z) - u.z * S(o_.x), u.y * S(o_.x) - u.x * S(o_.y)};
    for (int k = 0; k < 3; ++k) put(1 + k, moment[k] + v.x * S(A_[k].x) + v.y * S(A_[k].y) + v.z * S(A_[k].z));
    for (int k = 0; k < 6; ++k) put(4 + k, u.x * S(I_[k].x) + u.y * S(I_[k].y) + u.z * S(I_[k].z));
  }

 private:
  Vec o_, A_[3], I_[6];  ///< columns of A, and of (3) by the six numbers of I
};

}  // namespace dyn::kernels
