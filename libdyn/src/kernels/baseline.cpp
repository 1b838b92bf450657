// The tables that are in the library itself: number by number, and with the packs that every processor of this architecture has.
#include "kernels/instantiate.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {

extern const ConstraintKernels scalar_constraints, baseline_constraints;

const Kernels scalar{"scalar", layoutStamp(), singleKernels<double>(), blockKernels<double>(), blockKernels<float>(), &scalar_constraints};

#if DYN_HAS_PACKS
const Kernels baseline{xsimd::default_arch::name(), layoutStamp(),        singleKernels<Pack<double>>(), blockKernels<Pack<double>>(),
                       blockKernels<Pack<float>>(), &baseline_constraints};
#else
const Kernels baseline = scalar;
#endif

}  // namespace dyn::kernels
