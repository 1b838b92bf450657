// The table that this source, with the others of its kind, is compiled for.
#include "kernels/table.hpp"

#include "kernels/table_parts.hpp"

#ifndef DYN_TABLE_NAME
#define DYN_TABLE_NAME "baseline"
#endif

namespace dyn::kernels {

const Kernels& compiledTable() {
  static const Kernels table{DYN_TABLE_NAME,    layoutStamp(),       singleKernels(), batchesOfDoubles(),
                             batchesOfFloats(), &tableConstraints(), jointsInLanes(), vectored()};
  return table;
}

}  // namespace dyn::kernels

#ifdef DYN_KERNELS_MODULE
extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() { return &dyn::kernels::compiledTable(); }
#endif
