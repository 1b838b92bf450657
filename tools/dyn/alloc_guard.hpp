// SPDX-License-Identifier: BSD-2-Clause
// Counts the heap allocations of a thread, for `dyn plugin check`.
#pragma once

namespace dyn::tool {

/// The number of allocations since the thread began, by malloc, calloc, realloc, their aligned forms and hence operator new; -1 where they cannot be
/// counted.
long allocationCount();
bool canCountAllocations();

}  // namespace dyn::tool
