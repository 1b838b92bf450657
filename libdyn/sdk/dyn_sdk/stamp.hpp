// The stamp both sides compute from their own headers; a plugin whose stamp differs is refused before any of its types is used. What runs when it
// is opened has run by then, in a child process first.
#pragma once

#include <dyn/joint/joint_type.hpp>
#include <dyn_sdk/abi.h>

#include <initializer_list>

namespace dyn::sdk {

constexpr std::uint32_t layoutStamp() {
  std::uint32_t h = 2166136261u;
  for (const std::size_t size :
       {sizeof(ParameterSpec), sizeof(ParameterArgument), sizeof(JointTypeInfo), sizeof(JointInstance), sizeof(JointBatch<double>),
        sizeof(ConfigurationBatch<double>), sizeof(SE3<double>), alignof(SE3<double>), sizeof(Dual<double>), alignof(JointInstance)})
    h = (h ^ static_cast<std::uint32_t>(size)) * 16777619u;
  return h;
}

#if defined(__x86_64__)
#define DYN_ARCHITECTURE "itanium-x86_64-lp64"
#elif defined(__aarch64__)
#define DYN_ARCHITECTURE "itanium-aarch64-lp64"
#else
#define DYN_ARCHITECTURE "itanium-other"
#endif

constexpr dyn_plugin_stamp stamp() {
  return {DYN_PLUGIN_MAGIC, DYN_PLUGIN_ABI_VERSION, sizeof(dyn_plugin_descriptor), layoutStamp(), DYN_ARCHITECTURE};
}

}  // namespace dyn::sdk
