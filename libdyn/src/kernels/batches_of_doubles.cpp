#include "kernels/block_kernels.hpp"
#include "kernels/table_parts.hpp"

namespace dyn::kernels {

BlockKernels<double> batchesOfDoubles() { return blockKernels<Doubles>(); }

}  // namespace dyn::kernels
