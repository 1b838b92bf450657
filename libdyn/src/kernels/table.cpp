// The table of the instruction set that this source and the others of DYN_TABLE_SOURCES are compiled for.
#include "kernels/table.hpp"

#include "kernels/table_parts.hpp"

/// dispatch.cpp calls this function of the module that it opens.
extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() {
  using namespace dyn::kernels;
  static const Kernels table{layoutStamp(), singleKernels(), batchesOfDoubles(), batchesOfFloats(), &tableConstraints(), jointsInLanes(), vectored()};
  return &table;
}
