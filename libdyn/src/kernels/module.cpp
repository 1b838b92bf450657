// The table of a shared object for one instruction set, which is whatever this file is compiled for.
#include "kernels/instantiate.hpp"

#include <dyn_sdk/pack.hpp>

extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() {
  using namespace dyn::kernels;
  static const Kernels table{DYN_KERNELS_NAME, layoutStamp(), singleKernels(), blockKernels<dyn::Pack<double>>(), blockKernels<dyn::Pack<float>>()};
  return &table;
}
