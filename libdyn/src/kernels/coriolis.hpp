// The Coriolis matrix (Echeandia and Wensing 2021, "Numerical methods to compute the Coriolis matrix and Christoffel symbols").
#pragma once

#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// C(q, v) into d.by_v, with C v = nle - g and dM/dt - 2 C skew-symmetric; after derivativesOutward, whose rates it replaces.
///   C_ij = s_i . (I ds_j/dt + B s_j) where j is on i's path, s_i . (I ds_j/dt + B s_j) of j's subtree where i is on j's,
/// with 2 B what coriolis() is: half of what the sweep makes of a rate of 2 ds/dt.
template <class Wide, class Pack, class S, class Order>
void coriolisMatrix(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  const int n = order.m.nvx;
  for (int k = 0; k < n; ++k) {
    DofVariation<S> x = d.dof[k];
    x.rate = S(2) * (x.rate - x.velocity);
    d.dof.put(k, x);
  }
  derivativesInward<Pack>(order, w, d);
  for (int k = 0; k < n; ++k) {
    const DofForces<S> x = d.force[k];
    const S half(0.5);
    d.force.put(k, {half * x.by_a, half * x.lever, half * x.by_q, half * x.by_v});
  }
  pathSweep<Wide>(order, w, d);
  order.backward([&]<class Joint>(const Joint&, int, int iv) {
    for (int l = 0; l < Joint::nv; ++l)
      for (int k = 0; k < Joint::nv; ++k) d.by_v.enterOwn(iv + k, iv + l, d.by_v.below[iv + l][iv + k]);
  });
}

}  // namespace dyn::kernels
