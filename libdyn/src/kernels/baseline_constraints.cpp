// The constraints of the tables in baseline.cpp.
#include "kernels/instantiate_constraints.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

template void addConstraints<double>(SingleKernels&);
#if DYN_HAS_PACKS
template void addConstraints<Pack<double>>(SingleKernels&);
#endif

}  // namespace dyn::kernels
