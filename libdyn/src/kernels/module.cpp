// The table of a shared object for one instruction set, which is whatever this file is compiled for.
#include "kernels/instantiate.hpp"
#include "kernels/strip_kernels.hpp"

#include <dyn_sdk/pack.hpp>

namespace dyn::kernels {
extern const ConstraintKernels module_constraints;
extern const PackedKernels module_vectored;
}  // namespace dyn::kernels

extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() {
  using namespace dyn::kernels;
  // Four joints in lanes, or degrees of freedom, whatever the width: limbs come in twos and fours, and are about as long.
  using Quad = dyn::Pack<double, xsimd::fma3<xsimd::avx2>>;
  static const Kernels table{DYN_KERNELS_NAME,
                             layoutStamp(),
                             singleKernels<Quad, dyn::Pack<double>>(),
                             blockKernels<dyn::Pack<double>>(),
                             blockKernels<dyn::Pack<float>>(),
                             &module_constraints,
                             stripKernels<Quad>(),
                             module_vectored};
  return &table;
}
