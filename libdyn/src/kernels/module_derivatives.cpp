// The derivatives of the table in module.cpp.
#include "kernels/instantiate_derivatives.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

using Quad = Pack<double, xsimd::fma3<xsimd::avx2>>;
template void addDerivatives<Quad, Pack<double>>(SingleKernels&);
template void runDerivatives(const CompactImpl&, BlockScratch<Pack<double>>&, Block<double>&);
template void runDerivatives(const CompactImpl&, BlockScratch<Pack<float>>&, Block<float>&);

}  // namespace dyn::kernels
