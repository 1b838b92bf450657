// One function a subcommand: it adds its options to the app and what to do to its callback.
#pragma once

#include <CLI/CLI.hpp>

namespace dyn::tool {

/// A subcommand's answer that is not an error of its own: the process exits with this code.
struct ExitCode {
  int code;
};

void addInfo(CLI::App& app);
void addCheck(CLI::App& app);
void addCodegen(CLI::App& app);
void addCollide(CLI::App& app);
void addCompute(CLI::App& app);
void addDemo(CLI::App& app);
void addAccuracy(CLI::App& app);
void addBench(CLI::App& app);
void addProfile(CLI::App& app);
void addPlugin(CLI::App& app);
void addSimulate(CLI::App& app);

}  // namespace dyn::tool
