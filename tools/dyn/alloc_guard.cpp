// SPDX-License-Identifier: BSD-2-Clause
// The program's own malloc & co. count, then call the C library's. Definitions in the executable precede those of every shared object, so plugins
// are counted too; operator new of libstdc++ calls malloc. A sanitizer has its own allocator, which must stay: then nothing is counted.
#include "alloc_guard.hpp"

#include <cstddef>

// gcc and clang announce a sanitizer in different ways.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DYN_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DYN_SANITIZED
#endif
#endif

#if defined(__GLIBC__) && !defined(DYN_SANITIZED)

#include <cerrno>

namespace {
// This variable belongs to the executable, so it lies in the static TLS block, and accessing it allocates nothing.
thread_local long count = 0;
}  // namespace

extern "C" {

void* __libc_malloc(std::size_t) noexcept;
void* __libc_calloc(std::size_t, std::size_t) noexcept;
void* __libc_realloc(void*, std::size_t) noexcept;
void* __libc_memalign(std::size_t, std::size_t) noexcept;

#define DYN_INTERPOSED __attribute__((visibility("default")))

DYN_INTERPOSED void* malloc(std::size_t size) noexcept {
  ++count;
  return __libc_malloc(size);
}
DYN_INTERPOSED void* calloc(std::size_t n, std::size_t size) noexcept {
  ++count;
  return __libc_calloc(n, size);
}
DYN_INTERPOSED void* realloc(void* old, std::size_t size) noexcept {
  ++count;
  return __libc_realloc(old, size);
}
DYN_INTERPOSED void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++count;
  return __libc_memalign(alignment, size);
}
DYN_INTERPOSED void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++count;
  return __libc_memalign(alignment, size);
}
DYN_INTERPOSED int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {
  if (alignment % sizeof(void*) != 0 || (alignment & (alignment - 1)) != 0) return EINVAL;
  ++count;
  void* memory = __libc_memalign(alignment, size);
  if (memory == nullptr) return ENOMEM;
  *out = memory;
  return 0;
}

}  // extern "C"

namespace dyn::tool {
long allocationCount() { return count; }
bool canCountAllocations() { return true; }
}  // namespace dyn::tool

#else

namespace dyn::tool {
long allocationCount() { return -1; }
bool canCountAllocations() { return false; }
}  // namespace dyn::tool

#endif
