// Which table: the best that this processor has and that is installed, or the one that DYN_SIMD names.
#include "kernels/table.hpp"

#include <dyn/error.hpp>

#include <dlfcn.h>

#include <cstdlib>
#include <cstring>
#include <string>

namespace dyn::kernels {

namespace {

/// Instruction sets that have a module, best first.
constexpr const char* modules[] = {"avx512", "avx2"};

bool processorHas(const char* name) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (std::strcmp(name, "avx2") == 0) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (std::strcmp(name, "avx512") == 0)
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("fma");
#endif
  (void)name;
  return false;
}

/// Modules lie in libdyn/kernels beside the library. They are never closed.
std::string moduleFile(const char* name) {
  Dl_info where;
  if (dladdr(reinterpret_cast<const void*>(&moduleFile), &where) == 0 || where.dli_fname == nullptr) return "";
  const std::string library = where.dli_fname;
  const std::size_t slash = library.rfind('/');
  return (slash == std::string::npos ? "." : library.substr(0, slash)) + "/libdyn/kernels/" + name + ".so";
}

const Kernels* open(const char* name, std::string& problem) {
  void* library = dlopen(moduleFile(name).c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    problem = dlerror();
    return nullptr;
  }
  const auto entry = reinterpret_cast<const Kernels* (*)()>(dlsym(library, "dyn_kernels"));
  const Kernels* table = entry ? entry() : nullptr;
  if (table == nullptr || table->layout != layoutStamp()) {
    problem = moduleFile(name) + " belongs to another libdyn";
    return nullptr;
  }
  return table;
}

const Kernels& choose() {
  std::string problem;
  const char* wanted = std::getenv("DYN_SIMD");
  if (wanted == nullptr || *wanted == '\0') {
    for (const char* name : modules)
      if (processorHas(name))
        if (const Kernels* table = open(name, problem)) return *table;
    return baseline;
  }
  if (std::strcmp(wanted, scalar.name) == 0) return scalar;
  if (std::strcmp(wanted, baseline.name) == 0) return baseline;
  for (const char* name : modules) {
    if (std::strcmp(wanted, name) != 0) continue;
    if (!processorHas(name)) throw Error(ErrorCode::argument, std::string("DYN_SIMD=") + wanted + ": this processor does not have it");
    if (const Kernels* table = open(name, problem)) return *table;
    throw Error(ErrorCode::argument, std::string("DYN_SIMD=") + wanted + ": " + problem);
  }
  throw Error(ErrorCode::argument,
              std::string("DYN_SIMD=") + wanted + " is not known; it is one of scalar, " + baseline.name + ", avx2, avx512, or unset for the best");
}

}  // namespace

const Kernels& active() {
  static const Kernels& chosen = choose();
  return chosen;
}

}  // namespace dyn::kernels
