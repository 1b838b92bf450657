// Opens a shared object and shakes hands with it. The only file pair that knows Boost.DLL.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn_sdk/abi.h>

namespace dyn {

/// Checks permissions, opens, compares stamps. The object stays loaded for the life of the process.
/// Throws Error(plugin) with the path, what was found and what was expected.
const dyn_plugin_descriptor& openPlugin(const std::string& path, Trust trust);

/// Folder of the library's own plugins: <folder of libdyn.so>/libdyn/plugins.
std::string builtinPluginDirectory();

}  // namespace dyn
