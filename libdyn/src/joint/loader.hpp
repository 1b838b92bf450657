// SPDX-License-Identifier: BSD-2-Clause
// Opens shared objects, which stay loaded for the life of the process. Only loader.hpp and loader.cpp use Boost.DLL.
#pragma once

#include "trusted_file.hpp"

#include <dyn/joint/registry.hpp>
#include <dyn_sdk/abi.h>

namespace dyn {

struct OpenedPlugin {
  const dyn_plugin_descriptor& descriptor;
  std::string remark;  ///< see PluginRecord
};
/// Checks permissions, opens the plugin and compares its stamp with the library's. The thread's floating-point environment stays as it was.
/// Throws Error(plugin) with the path, what was found and what was expected.
OpenedPlugin openPlugin(const std::string& path, Trust trust);

/// Returns a function of a shared object that the caller trusts, or null if the object cannot be loaded or has no such function.
void* openFunction(const OpenFile& file, const std::string& name);

/// Folder of the library's own plugins: <folder of libdyn.so>/libdyn/plugins.
std::string builtinPluginDirectory();

}  // namespace dyn
