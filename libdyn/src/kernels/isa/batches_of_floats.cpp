// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/isa/block_kernels.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

BlockKernels<float> batchesOfFloats() { return blockKernels<Floats>(); }

}  // namespace dyn::kernels
