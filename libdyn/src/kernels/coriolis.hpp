// The Coriolis matrix (Echeandia and Wensing 2021, "Numerical methods to compute the Coriolis matrix and Christoffel symbols").
#pragma once

#include "kernels/rnea_derivatives.hpp"

namespace dyn::kernels {

/// C(q, v) into d.by_q, with C v = nle - g and dM/dt - 2 C skew-symmetric; after derivativesOutward and derivativesInward.
///   C_ij = s_i . (I ds_j/dt + B s_j) where j is on i's path, s_i . (I ds_i... + B s_i) of the lower subtree where i is on j's,
/// with 2 B what coriolis() is.
template <class Wide, class S, class Order>
void coriolisSweep(const Order& order, Workspace<S>& w, DerivativeWorkspace<S>& d) {
  using D = DerivativeWorkspace<S>;
  const Rows<S> levers{d.force[D::lever], d.force.stride}, forces{d.force[D::force_by_q], d.force.stride};
  for (int k = 0; k < order.m.nvx; ++k) {
    const int i = order.m.dof_body[static_cast<std::size_t>(k)];
    const Motion<S> rate = d.dof[k].rate - d.dof[k].velocity;
    writeForce(rigidForce(w.mass[i], w.h[i], w.Io[i], rate) + S(0.5) * coriolis(d.body[i], w.dof[k].S_.angular), forces, k);
  }
  order.backward([&]<class Joint>(const Joint&, int i, int iv) {
    inParts<Wide, S>(iv, order.dofEnd(i), [&](const Part<Wide, S>& part) {
      const Force<Wide> U = loadForce(part, d.force), F = loadForce(part, forces);
      const Vec3<Wide> lever = loadVector(part, levers);
      for (int k = 0; k < Joint::nv; ++k) {
        const Motion<S> rate = d.dof[iv + k].rate - d.dof[iv + k].velocity;
        const Column<Joint, S> column{w.dof[iv + k].S_};
        d.by_q.enterBelow(part, iv + k, dot(broadcast<Wide>(rate), U) + Wide(S(0.5)) * dot(broadcast<Wide>(column.s.angular), lever));
        d.by_q.enterRight(part, iv + k, iv + Joint::nv, column.along(F));
      }
      if (order.isRoot(i)) return;
      const Wide inside = part.inside();
      const Vec3<Wide> here = inside * broadcast<Wide>(w.r[i]), speed = inside * broadcast<Wide>(S(2) * d.body[i].shift_rate);
      storeVector(part, U.angular + cross(here, U.linear), d.force, 3);
      storeVector(part, lever + cross(speed, U.linear), levers);
      storeVector(part, F.angular + cross(here, F.linear), forces, 3);
    });
    for (int l = 0; l < Joint::nv; ++l)
      for (int k = 0; k < Joint::nv; ++k) d.by_q.enterOwn(iv + k, iv + l, d.by_q.below[iv + l][iv + k]);
  });
}

}  // namespace dyn::kernels
