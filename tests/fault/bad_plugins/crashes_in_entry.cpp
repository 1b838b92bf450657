// SPDX-License-Identifier: BSD-2-Clause
// The exported function reads an invalid address instead of describing the plugin.
struct dyn_plugin_descriptor;
extern "C" __attribute__((visibility("default"))) const dyn_plugin_descriptor* dyn_plugin_descriptor_v1() {
  return *reinterpret_cast<const dyn_plugin_descriptor* volatile*>(16);
}
