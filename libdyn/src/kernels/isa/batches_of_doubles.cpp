// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/isa/block_kernels.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

BlockKernels<double> batchesOfDoubles() { return blockKernels<Doubles>(); }

}  // namespace dyn::kernels
