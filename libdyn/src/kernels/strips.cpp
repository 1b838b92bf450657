// Single states with joints in lanes, of one table.
#include "kernels/table_parts.hpp"

#if defined(__AVX2__) && defined(__FMA__)
#include "kernels/strip_kernels.hpp"
#endif

namespace dyn::kernels {

PackedKernels jointsInLanes() {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (joints_in_lanes) return stripKernels<Wide>();
#endif
  return {};
}

}  // namespace dyn::kernels
