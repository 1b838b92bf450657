// SPDX-License-Identifier: BSD-2-Clause
// The memory of the torque regressor's recursion (torque_regressor.hpp).
#pragma once

#include "kernels/body/workspace.hpp"

namespace dyn::kernels {

/// The recursion writes these for one state.
struct TorqueRegressorMemory {
  Rows<double> motions;           ///< component c of degree of freedom k: world axes, about the origin of the root of its tree
  Vec3<double>* place = nullptr;  ///< by body: its origin from there
  /// By degree of freedom: it is on the root paths of those in [own, end), with room for a pack. Never changes.
  double *own = nullptr, *end = nullptr;
};

inline void layOut(TorqueRegressorMemory& x, const CompactImpl& m, Arena& arena) {
  const auto n = static_cast<std::size_t>(m.nvx), room = n + most_lanes;
  arena.take(x.motions, 6, m.nvx + most_lanes);
  arena.take(x.place, static_cast<std::size_t>(m.bodies()));
  arena.take(x.own, room);
  arena.take(x.end, room);
  for (std::size_t k = 0; x.end != nullptr && k < n; ++k) {
    x.own[k] = static_cast<double>(k);
    x.end[k] = m.dof_end[k];
  }
}

}  // namespace dyn::kernels
