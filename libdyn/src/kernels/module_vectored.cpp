// The kernels on vectors in registers of the table in module.cpp.
#include "kernels/vectored_kernels.hpp"

namespace dyn::kernels {

extern const PackedKernels module_vectored;
const PackedKernels module_vectored = vectoredKernels();

}  // namespace dyn::kernels
