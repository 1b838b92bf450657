// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/isa/block_kernels.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

// constraints.cpp uses these.
template void articulateStates(const CompactImpl&, BlockScratch<Doubles>&, Block<double>&);
template void accelerateStates(const CompactImpl&, BlockScratch<Doubles>&, const Vec3<double>&, Block<double>&);

BlockKernels<double> batchesOfDoubles() { return blockKernels<Doubles>(); }

}  // namespace dyn::kernels
