// The constraints of the tables in baseline.cpp.
#include "kernels/instantiate_constraints.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

extern const ConstraintKernels scalar_constraints, baseline_constraints;
const ConstraintKernels scalar_constraints = singleConstraintKernels<double, double>();
#if DYN_HAS_PACKS
const ConstraintKernels baseline_constraints = singleConstraintKernels<Pack<double>, Pack<double>>();
#endif

}  // namespace dyn::kernels
