#include "kernels/block_kernels.hpp"
#include "kernels/table_parts.hpp"

namespace dyn::kernels {

BlockKernels<float> batchesOfFloats() { return blockKernels<Floats>(); }

}  // namespace dyn::kernels
