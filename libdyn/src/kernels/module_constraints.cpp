// The constraints of the table in module.cpp.
#include "kernels/instantiate_constraints.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

template void addConstraints<Pack<double>>(SingleKernels&);
template void addStripConstraints<Pack<double, xsimd::fma3<xsimd::avx2>>>(StripKernels&);

}  // namespace dyn::kernels
