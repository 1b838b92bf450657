// The constraints of the table in module.cpp.
#include "kernels/instantiate_constraints.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

extern const ConstraintKernels module_constraints;
const ConstraintKernels module_constraints = [] {
  using Four = Pack<double, xsimd::fma3<xsimd::avx2>>;
  ConstraintKernels k = singleConstraintKernels<Pack<double>, Four>();
  k.strips = constraintRecursions<Pack<double>, Four, Four>();
  return k;
}();

}  // namespace dyn::kernels
