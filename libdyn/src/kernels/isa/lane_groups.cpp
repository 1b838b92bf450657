// SPDX-License-Identifier: BSD-2-Clause
// Kernels of one table for single states with joints in lanes.
#include "kernels/isa/table_parts.hpp"

#if DYN_JOINTS_IN_LANES
#include "kernels/isa/lane_group_kernels.hpp"
#endif

namespace dyn::kernels {

PackedKernels jointsInLanes() {
#if DYN_JOINTS_IN_LANES
  return laneGroupKernels<Wide>();
#else
  return {};
#endif
}

}  // namespace dyn::kernels
