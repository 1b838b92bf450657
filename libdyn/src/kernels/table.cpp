// The table of the instruction set that this source and the others of DYN_TABLE_SOURCES are compiled for.
#include "kernels/table.hpp"

#include "kernels/table_parts.hpp"

namespace dyn::kernels {

const Kernels& compiledTable() {
  static const Kernels table{layoutStamp(), singleKernels(), batchesOfDoubles(), batchesOfFloats(), &tableConstraints(), jointsInLanes(), vectored()};
  return table;
}

}  // namespace dyn::kernels

#ifdef DYN_KERNELS_MODULE
extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() { return &dyn::kernels::compiledTable(); }
#endif
