// SPDX-License-Identifier: BSD-2-Clause
// The table of kernels of one module. All DYN_TABLE_SOURCES are compiled for the instruction set of the module.
#include "kernels/isa/table.hpp"

#include "kernels/isa/table_parts.hpp"

/// dispatch.cpp calls this function after it has opened the module.
extern "C" __attribute__((visibility("default"))) const dyn::kernels::Kernels* dyn_kernels() {
  using namespace dyn::kernels;
  static const Kernels table{layoutStamp(), singleKernels(), batchesOfDoubles(), batchesOfFloats(), &tableConstraints(), jointsInLanes(), vectored()};
  return &table;
}
