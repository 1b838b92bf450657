// SPDX-License-Identifier: BSD-2-Clause
// The registry of joint types that the module's functions share.
#pragma once

#include "module.hpp"

#include <dyn/joint/registry.hpp>

namespace dyn::python {

/// A type without its code. Plugins are never unloaded, so the description stays where it is.
struct TypeInfo {
  const JointTypeInfo* info;
  const char* role;  ///< "joint" or "coupling"
};

/// Returns the registry that all calls share unless they are given another one. Callers hold the interpreter's lock while they read or load it.
JointRegistry& registry();
/// Returns the given registry, or else the shared one.
const JointRegistry& registryOr(const JointRegistry* given);

}  // namespace dyn::python
