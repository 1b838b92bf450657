// SPDX-License-Identifier: BSD-2-Clause
#include "joint/processor.hpp"

#include <dyn/version.hpp>
#include <dyn_sdk/abi.h>

namespace dyn {

Version version() { return {DYN_VERSION, DYN_BUILD_TYPE, instructionSet(), DYN_PLUGIN_ABI_VERSION}; }

}  // namespace dyn
