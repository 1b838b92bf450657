// SPDX-License-Identifier: BSD-2-Clause
// The stamp that the library and a plugin compute from their own headers. The library refuses a plugin with another stamp before it uses any of the
// plugin's types. Code that runs when the plugin is opened has run by then, but in a child process first.
#pragma once

#include <dyn/joint/joint_type.hpp>
#include <dyn_sdk/abi.h>

#include <initializer_list>

namespace dyn::sdk {

/// Returns a hash of the sizes of types that cross the interface, and of two alignments.
constexpr std::uint32_t layoutStamp() {
  std::uint32_t h = 2166136261u;
  for (const std::size_t size :
       {sizeof(ParameterSpec), sizeof(ParameterArgument), sizeof(JointTypeInfo), sizeof(JointInstance), sizeof(JointBatch<double>),
        sizeof(ConfigurationBatch<double>), sizeof(SE3<double>), alignof(SE3<double>), sizeof(Dual<double>), alignof(JointInstance)})
    h = (h ^ static_cast<std::uint32_t>(size)) * 16777619u;
  return h;
}

/// The C++ ABI and the architecture for which this file is compiled.
#if defined(__x86_64__)
#define DYN_ARCHITECTURE "itanium-x86_64-lp64"
#elif defined(__aarch64__)
#define DYN_ARCHITECTURE "itanium-aarch64-lp64"
#else
#define DYN_ARCHITECTURE "itanium-other"
#endif

/// Returns the stamp of the headers with which this file is compiled.
constexpr dyn_plugin_stamp stamp() {
  return {DYN_PLUGIN_MAGIC, DYN_PLUGIN_ABI_VERSION, sizeof(dyn_plugin_descriptor), layoutStamp(), DYN_ARCHITECTURE};
}

}  // namespace dyn::sdk
