// Counts the heap allocations of a thread, for `dyn plugin check`.
#pragma once

namespace dyn::tool {

/// malloc, calloc, realloc, aligned forms and with them operator new, since the thread began; -1 where they cannot be counted.
long allocationCount();
bool canCountAllocations();

}  // namespace dyn::tool
