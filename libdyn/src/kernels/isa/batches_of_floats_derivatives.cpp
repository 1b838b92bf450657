// SPDX-License-Identifier: BSD-2-Clause
#include "kernels/isa/block_derivatives.hpp"
#include "kernels/isa/table_parts.hpp"

namespace dyn::kernels {

template void runDerivatives(const CompactImpl&, BlockScratch<Floats>&, Block<float>&);

}  // namespace dyn::kernels
