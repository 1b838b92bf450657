// SPDX-License-Identifier: BSD-2-Clause
// One function per subcommand. It adds the subcommand's options to the app and sets its callback. The tree of apps and options is the only
// description of the command line: parser, help, manual pages and completion follow from it.
#pragma once

#include <CLI/CLI.hpp>

namespace dyn::tool {

/// Adds the options that every subcommand has: --quiet, --verbose and --color.
void addMessageOptions(CLI::App& app);
/// Adds a subcommand with these options.
CLI::App* addCommand(CLI::App& app, const std::string& name, const std::string& summary);

/// Thrown by a subcommand to end the process with this code, without an error message.
struct ExitCode {
  int code;
};

void addInfo(CLI::App& app);
void addCheck(CLI::App& app);
void addCodegen(CLI::App& app);
void addCollide(CLI::App& app);
void addCompute(CLI::App& app);
void addConvert(CLI::App& app);
void addDemo(CLI::App& app);
void addDiff(CLI::App& app);
void addAccuracy(CLI::App& app);
void addBench(CLI::App& app);
void addProfile(CLI::App& app);
void addPlugin(CLI::App& app);
void addSimulate(CLI::App& app);
void addSweep(CLI::App& app);
void addTruth(CLI::App& app);
/// These two describe all subcommands of the app, also those added after them.
void addHelp(CLI::App& app);
void addCompletion(CLI::App& app);

}  // namespace dyn::tool
