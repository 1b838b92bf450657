// SPDX-License-Identifier: BSD-2-Clause
// The exported function throws instead of describing the plugin.
#include <stdexcept>

struct dyn_plugin_descriptor;
extern "C" __attribute__((visibility("default"))) const dyn_plugin_descriptor* dyn_plugin_descriptor_v1() { throw std::runtime_error("not today"); }
