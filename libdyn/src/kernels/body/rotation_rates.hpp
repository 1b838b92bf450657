// SPDX-License-Identifier: BSD-2-Clause
// Effects of a body's rotation on points and masses that are fixed to it.
#pragma once

#include <dyn/scalar/select.hpp>
#include <dyn/spatial/inertia.hpp>

namespace dyn::kernels {

/// A body's angular velocity w and angular acceleration a.
template <class S, bool by_matrix = (lanes_of<S> > 1) || is_symbolic<S>>
class RotationRates {
 public:
  RotationRates(const Vec3<S>& w, const Vec3<S>& a) : w_(w), a_(a) {}
  /// Acceleration of the point r: origin + a x r + w x (w x r), where `origin` is the acceleration of the origin.
  Vec3<S> at(const Vec3<S>& origin, const Vec3<S>& r) const { return origin + cross(a_, r) + cross(w_, cross(w_, r)); }
  /// Torque that moves the rotational inertia I: I a + w x I w.
  Vec3<S> torque(const Sym3<S>& I) const { return I * a_ + cross(w_, I * w_); }

 private:
  Vec3<S> w_, a_;
};

/// The same with the matrix [a]x + [w]x [w]x, whose entries also occur in the torque. This takes fewer multiplications. For single numbers too many
/// of them wait for earlier results. Packs give the core other work meanwhile, and generated code is ordered so that few operations wait.
template <class S>
class RotationRates<S, true> {
 public:
  RotationRates(const Vec3<S>& w, const Vec3<S>& a)
      : a_(a), xx_(w.x * w.x), yy_(w.y * w.y), zz_(w.z * w.z), xy_(w.x * w.y), yz_(w.y * w.z), zx_(w.z * w.x) {}
  Vec3<S> at(const Vec3<S>& origin, const Vec3<S>& r) const {
    return origin + Vec3<S>{(xy_ - a_.z) * r.y + (zx_ + a_.y) * r.z - (yy_ + zz_) * r.x, (xy_ + a_.z) * r.x + (yz_ - a_.x) * r.z - (zz_ + xx_) * r.y,
                            (zx_ - a_.y) * r.x + (yz_ + a_.x) * r.y - (xx_ + yy_) * r.z};
  }
  Vec3<S> torque(const Sym3<S>& I) const {
    // The sum goes entry by entry of I, so that an entry is in a register for all of its products.
    Vec3<S> sum{I.xx * a_.x, I.yy * a_.y, I.zz * a_.z};
    sum.x += (I.zz - I.yy) * yz_;
    sum.y += (I.xx - I.zz) * zx_;
    sum.z += (I.yy - I.xx) * xy_;
    sum.x += I.xy * (a_.y - zx_);
    sum.y += I.xy * (a_.x + yz_);
    sum.z += I.xy * (xx_ - yy_);
    sum.x += I.xz * (a_.z + xy_);
    sum.y += I.xz * (zz_ - xx_);
    sum.z += I.xz * (a_.x - yz_);
    sum.x += I.yz * (yy_ - zz_);
    sum.y += I.yz * (a_.z - xy_);
    sum.z += I.yz * (a_.y + zx_);
    return sum;
  }

 private:
  Vec3<S> a_;
  S xx_, yy_, zz_, xy_, yz_, zx_;
};

}  // namespace dyn::kernels
