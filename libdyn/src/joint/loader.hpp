// Opens shared objects, which stay loaded for the life of the process. The only file pair that knows Boost.DLL.
#pragma once

#include <dyn/joint/registry.hpp>
#include <dyn_sdk/abi.h>

namespace dyn {

/// Checks permissions, opens, shakes hands by comparing stamps.
/// Throws Error(plugin) with the path, what was found and what was expected.
const dyn_plugin_descriptor& openPlugin(const std::string& path, Trust trust);

/// A function of a shared object that the caller trusts; null if it cannot be opened, or has no such function.
void* openFunction(const std::string& path, const std::string& name);

/// Folder of the library's own plugins: <folder of libdyn.so>/libdyn/plugins.
std::string builtinPluginDirectory();

}  // namespace dyn
