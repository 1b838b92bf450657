// Opens shared objects, which stay loaded for the life of the process. The only file pair that knows Boost.DLL.
#pragma once

#include "trusted_file.hpp"

#include <dyn/joint/registry.hpp>
#include <dyn_sdk/abi.h>

namespace dyn {

struct OpenedPlugin {
  const dyn_plugin_descriptor& descriptor;
  std::string remark;  ///< see PluginRecord
};
/// Checks permissions, opens, shakes hands by comparing stamps. The thread's floating-point environment stays as it was.
/// Throws Error(plugin) with the path, what was found and what was expected.
OpenedPlugin openPlugin(const std::string& path, Trust trust);

/// A function of a shared object that the caller trusts; null if it cannot be loaded, or has no such function.
void* openFunction(const OpenFile& file, const std::string& name);

/// Folder of the library's own plugins: <folder of libdyn.so>/libdyn/plugins.
std::string builtinPluginDirectory();

}  // namespace dyn
