// Single states with vectors in registers, of one table.
#include "kernels/table_parts.hpp"

#if defined(__AVX2__) && defined(__FMA__)
#include "kernels/vectored_kernels.hpp"
#endif

namespace dyn::kernels {

PackedKernels vectored() {
#if defined(__AVX2__) && defined(__FMA__)
  if constexpr (joints_in_lanes) return vectoredKernels();
#endif
  return {};
}

}  // namespace dyn::kernels
