// The mass matrix from composite inertias in aligned frames (Featherstone 2008, ch. 6).
#pragma once

#include "kernels/aligned.hpp"

namespace dyn::kernels {

/// Rotational inertia about a point at distance r from the old origin (old origin = new origin + r), first moment h, mass m.
template <class S>
Sym3<S> shiftedInertia(const Sym3<S>& I, const S& mass, const Vec3<S>& h, const Vec3<S>& r) {
  const Vec3<S> k = h + S(0.5) * mass * r;  // I + [..] = I - (h r^T + r h^T + m r r^T) + trace part, symmetric in h + m r / 2
  const S t = S(2) * dot(k, r), kx = S(2) * k.x * r.x, ky = S(2) * k.y * r.y, kz = S(2) * k.z * r.z;
  return I + Sym3<S>{t - kx, -(k.x * r.y + r.x * k.y), -(k.x * r.z + r.x * k.z), t - ky, -(k.y * r.z + r.y * k.z), t - kz};
}

/// M of the expanded coordinates, n x n: entries of joints on one path to the root, both triangles. The others are zero and never
/// written: M must have been zero once.
template <class S, class Order>
void massMatrix(const Order& order, Workspace<S>& w, S* M) {
  const std::ptrdiff_t n = order.m.nvx;
  order.forward([&]<class Joint>(const Joint& joint, int i, int iv) {
    const auto& c = order.constants(i);
    placeAligned<S>(joint, order, c.placement, i, w);
    const Mat3<S>& R = w.R[i];
    w.mass[i] = c.mass;
    w.h[i] = R * c.h;
    w.Io[i] = congruence(R, c.origin);
    writeColumns(joint, R, w.dof + iv);
  });
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    Force<S> F[Joint::nv];
    for (int k = 0; k < Joint::nv; ++k) {
      const Motion<S>& column = w.dof[iv + k].S_;
      F[k].linear = cross(column.angular, w.h[i]);
      F[k].angular = w.Io[i] * column.angular;
      if constexpr (Joint::has_linear) {
        F[k].linear += w.mass[i] * column.linear;
        F[k].angular += cross(w.h[i], column.linear);
      }
    }
    for (int k = 0; k < Joint::nv; ++k)
      for (int l = 0; l <= k; ++l) {
        const S x = dot(w.dof[iv + l].S_, F[k]);
        M[(iv + k) * n + iv + l] = M[(iv + l) * n + iv + k] = x;
      }
    const int p = order.parentOf(i);
    for (int j = i, up = p; up > 0; j = up, up = order.parentOf(up)) {
      for (int k = 0; k < Joint::nv; ++k) F[k].angular += cross(w.r[j], F[k].linear);
      const BodyIndex& x = order.index(up);
      const auto enter = [&](int l, int k, const S& value) { M[(iv + k) * n + x.idx_v + l] = M[(x.idx_v + l) * n + iv + k] = value; };
      if (x.flying_root) {
        for (int k = 0; k < Joint::nv; ++k)
          for (int l = 0; l < 3; ++l) {
            enter(l, k, F[k].linear[l]);
            enter(3 + l, k, F[k].angular[l]);
          }
        break;
      }
      for (int l = 0; l < x.nv; ++l)
        for (int k = 0; k < Joint::nv; ++k) {
          const Motion<S>& column = w.dof[x.idx_v + l].S_;
          enter(l, k, x.turns_only ? dot(column.angular, F[k].angular) : dot(column, F[k]));
        }
    }
    if (p > 0) {
      w.Io[p] = w.Io[p] + shiftedInertia(w.Io[i], w.mass[i], w.h[i], w.r[i]);
      w.h[p] += w.h[i] + w.mass[i] * w.r[i];
      w.mass[p] += w.mass[i];
    }
  });
  for (std::ptrdiff_t k = 0; k < n; ++k) M[k * n + k] += order.armature(static_cast<int>(k));
}

}  // namespace dyn::kernels
