// The Coriolis matrix (Echeandia and Wensing 2021, "Numerical methods to compute the Coriolis matrix and Christoffel symbols").
#pragma once

#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// C(q, v) into d.by_v, or d.pairs, with C v = nle - g and dM/dt - 2 C skew-symmetric; joints asked into w, how subspaces vary into d.
///   C_ij = s_i . (I ds_j/dt + B s_j) where j is on i's path, s_i . (I ds_j/dt + B s_j) of j's subtree where i is on j's,
/// with 2 B what coriolis() is: half of what the sweep makes of a rate of 2 ds/dt.
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
    x = {half * x.by_a, half * x.lever, half * x.by_q, half * x.by_v};
  }
  pathSweep<Wide>(r, d);
  closeJoints(m, d);
}

}  // namespace dyn::kernels
