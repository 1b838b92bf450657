// SPDX-License-Identifier: BSD-2-Clause
// Centroidal quantities: momentum, its rate, and their maps from velocities.
#pragma once

#include <dyn/spatial/inertia.hpp>

namespace dyn::kernels {

/// Arrays of columns of 6 numbers, linear part first, in world axes about the centre of mass. A null pointer means that the map is not wanted.
template <class S>
struct CentroidalMaps {
  S *Ag = nullptr, *dAg = nullptr;                               ///< the map from v to the momentum, and its time derivative
  S *dh_dq = nullptr, *dhdot_dq = nullptr, *dhdot_dv = nullptr;  ///< derivatives of the momentum and of its rate

  bool rates() const { return dAg || dh_dq || dhdot_dq || dhdot_dv; }  ///< whether more than Ag and the momentum is wanted
};
template <class S>
struct CentroidalState {
  Force<S> momentum, rate;  ///< world axes, about the centre of mass
  Sym3<S> inertia;          ///< of the whole model with its joints locked, about the centre of mass, world axes
  S mass;
};

}  // namespace dyn::kernels
