// SPDX-License-Identifier: BSD-2-Clause
// Kernels of one table for single states with vectors in registers.
#include "kernels/isa/table_parts.hpp"

#if DYN_JOINTS_IN_LANES
#include "kernels/isa/vectored_kernels.hpp"
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
