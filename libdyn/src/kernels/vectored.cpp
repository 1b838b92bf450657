// Single states with vectors in registers, of one table.
#include "kernels/table_parts.hpp"

#if DYN_JOINTS_IN_LANES
#include "kernels/vectored_kernels.hpp"
#endif

namespace dyn::kernels {

PackedKernels vectored() {
#if DYN_JOINTS_IN_LANES
  return vectoredKernels();
#else
  return {};
#endif
}

}  // namespace dyn::kernels
