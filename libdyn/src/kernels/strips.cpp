// Single states with joints in lanes, of one table.
#include "kernels/table_parts.hpp"

#if DYN_JOINTS_IN_LANES
#include "kernels/strip_kernels.hpp"
#endif

namespace dyn::kernels {

PackedKernels jointsInLanes() {
#if DYN_JOINTS_IN_LANES
  return stripKernels<Wide>();
#else
  return {};
#endif
}

}  // namespace dyn::kernels
