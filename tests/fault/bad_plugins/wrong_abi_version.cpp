// SPDX-License-Identifier: BSD-2-Clause
// The plugin's stamp has an ABI version that is not this library's.
#include <dyn_sdk/stamp.hpp>

extern "C" __attribute__((visibility("default"))) const dyn_plugin_descriptor* dyn_plugin_descriptor_v1() {
  static dyn_plugin_descriptor descriptor{dyn::sdk::stamp(), 0, 0, nullptr, nullptr};
  descriptor.stamp.abi_version = 99;
  return &descriptor;
}
