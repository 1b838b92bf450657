// SPDX-License-Identifier: BSD-2-Clause
#include "joint/processor.hpp"

#include <dyn/error.hpp>

#include <cstdlib>

namespace dyn {

namespace {

/// Whether libdyn was built with kernels for this instruction set. CMake lists them in DYN_KERNEL_SETS.
bool built(const std::string& name) { return std::string(" " DYN_KERNEL_SETS " ").find(" " + name + " ") != std::string::npos; }

bool processorHas(const std::string& name) {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (name == "avx2") return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (name == "avx512")
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
           __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("fma");
#endif
  return name == "scalar" || name == "baseline";
}

std::string choose() {
  const char* wanted = secure_getenv("DYN_SIMD");
  if (wanted == nullptr || *wanted == '\0') {
    for (const char* best : {"avx512", "avx2", "baseline"})
      if (processorHas(best) && built(best)) return best;
    throw Error(ErrorCode::argument,
                "this libdyn is built for " DYN_KERNEL_SETS " alone, which this processor does not have; configure with -DDYN_INSTRUCTION_SETS=all");
  }
  std::string name = wanted;
#if defined(__x86_64__)
  if (name == "sse2") name = "baseline";
#endif
  for (const char* known : {"scalar", "baseline", "avx2", "avx512"}) {
    if (name != known) continue;
    if (!processorHas(name)) throw Error(ErrorCode::argument, std::string("DYN_SIMD=") + wanted + ": this processor does not have it");
    if (!built(name))
      throw Error(ErrorCode::argument,
                  std::string("DYN_SIMD=") + wanted + ": this libdyn is built without it; configure with -DDYN_INSTRUCTION_SETS=all");
    return name;
  }
  throw Error(ErrorCode::argument,
              std::string("DYN_SIMD=") + wanted + " is not known; it is one of scalar, sse2 (baseline), avx2, avx512, or unset for the best");
}

}  // namespace

const std::string& instructionSet() {
  static const std::string chosen = choose();
  return chosen;
}

}  // namespace dyn
