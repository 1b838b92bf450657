#include "joint/processor.hpp"

#include <dyn/error.hpp>

#include <cstdlib>

namespace dyn {

namespace {

/// Best first.
constexpr const char* modern[] = {"avx512", "avx2"};

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

InstructionSet choose() {
  const char* wanted = std::getenv("DYN_SIMD");
  if (wanted == nullptr || *wanted == '\0') {
    for (const char* name : modern)
      if (processorHas(name)) return {name, false};
    return {"baseline", false};
  }
  std::string name = wanted;
#if defined(__x86_64__)
  if (name == "sse2") name = "baseline";
#endif
  for (const char* known : {"scalar", "baseline", "avx2", "avx512"}) {
    if (name != known) continue;
    if (!processorHas(name)) throw Error(ErrorCode::argument, std::string("DYN_SIMD=") + wanted + ": this processor does not have it");
    return {name, true};
  }
  throw Error(ErrorCode::argument,
              std::string("DYN_SIMD=") + wanted + " is not known; it is one of scalar, sse2 (baseline), avx2, avx512, or unset for the best");
}

}  // namespace

const InstructionSet& instructionSet() {
  static const InstructionSet chosen = choose();
  return chosen;
}

}  // namespace dyn
