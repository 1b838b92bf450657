// SPDX-License-Identifier: BSD-2-Clause
// The plugin's stamp has another layout, as if it were built with structs of other sizes.
#include <dyn_sdk/stamp.hpp>

extern "C" __attribute__((visibility("default"))) const dyn_plugin_descriptor* dyn_plugin_descriptor_v1() {
  static dyn_plugin_descriptor descriptor{dyn::sdk::stamp(), 0, 0, nullptr, nullptr};
  descriptor.stamp.layout ^= 1;
  return &descriptor;
}
