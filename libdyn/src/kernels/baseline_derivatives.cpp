// The derivatives of the tables in baseline.cpp.
#include "kernels/instantiate_derivatives.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

template void addDerivatives<double, double>(SingleKernels&);
template void runDerivatives(const CompactImpl&, BlockScratch<double>&, Block<double>&);
template void runDerivatives(const CompactImpl&, BlockScratch<float>&, Block<float>&);

#if DYN_HAS_PACKS
template void addDerivatives<Pack<double>, Pack<double>>(SingleKernels&);
template void runDerivatives(const CompactImpl&, BlockScratch<Pack<double>>&, Block<double>&);
template void runDerivatives(const CompactImpl&, BlockScratch<Pack<float>>&, Block<float>&);
#endif

}  // namespace dyn::kernels
