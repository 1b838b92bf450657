// SPDX-License-Identifier: BSD-2-Clause
// The subcommands of `dyn plugin`.
#pragma once

#include "commands.hpp"

namespace dyn::tool {

void addPluginCheck(CLI::App& plugin);
void addPluginNew(CLI::App& plugin);

}  // namespace dyn::tool
