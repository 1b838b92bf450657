// SPDX-License-Identifier: BSD-2-Clause
// The Coriolis matrix C(q, v), with C v = nle - g and dM/dt - 2 C skew-symmetric (Echeandia and Wensing 2021, "Numerical methods to compute the
// Coriolis matrix and Christoffel symbols"). O(n depth).
//
// Letters, rigid() and coriolis() as in rnea_derivatives.hpp, with a = 0 and without gravity. For degree of freedom j and k on its root path:
//
//   (1)  dS/dt = (w x S_v, w x S_w) + sum_l dS/dq_l v_l = rate - velocity
//   (2)  by_a = rigid(S),   offset as there in (9),   by_v = rigid(dS/dt) + coriolis(S_w) / 2        moved along the root path as there in (14)
//   (3)  C_kj = S_k . by_v,   C_jk = dS_k/dt . by_a + S_w,k . offset / 2                             within a joint the second for both triangles
#pragma once

#include "kernels/derivative/rnea_derivatives.hpp"

namespace dyn::kernels {

/// Writes C(q, v) to d.by_v, or to d.pairs. w has the evaluated joints, d the derivatives of their subspaces. The sweep of the derivatives by v, with
/// 2 dS/dt in the place of rate, gives twice C: so the forces are halved before it.
template <class Wide, class S>
void coriolisMatrix(const CompactImpl& m, Workspace<S>& w, DerivativeWorkspace<S>& d, const S* v, const S* zeros) {
  const auto r = recursion(m, w, d);
  using T = typename decltype(r)::Scalar;
  const int n = m.nvx;
  derivativesOutward(r.order, r.d, Vec3<T>{}, r.velocities(v), r.accelerations(zeros));
  for (int k = 0; k < n; ++k) {
    DofVariation<T>& x = r.d.dof[k];
    x.rate = T(2) * (x.rate - x.velocity);
  }
  derivativesInward(r.order, r.d);
  for (int k = 0; k < n; ++k) {
    DofForces<T>& x = r.d.dof_force[k];
    const T half(0.5);
    x = {half * x.by_a, half * x.offset, half * x.by_q, half * x.by_v};
  }
  pathSweep<Wide>(r, d);
  closeJoints(m, d);
}

}  // namespace dyn::kernels
