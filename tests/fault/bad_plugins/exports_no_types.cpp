// SPDX-License-Identifier: BSD-2-Clause
// A plugin without types.
#include <dyn_sdk/joint_plugin.hpp>

DYN_EXPORT_JOINTS()
