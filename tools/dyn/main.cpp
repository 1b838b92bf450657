// SPDX-License-Identifier: BSD-2-Clause
// The command dyn. Exit codes: 0 success; 1 the model, the input or the answer is wrong, or output was lost; 2 the command line is wrong.
#include "commands.hpp"
#include "interrupt.hpp"
#include "messages.hpp"
#include "options.hpp"

#include <dyn/parsers/load.hpp>
#include <dyn/version.hpp>

#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

namespace {

/// Returns the formats of models that this program reads.
std::string formats() {
  std::string out;
  for (const dyn::ModelFormat& format : dyn::modelFormats())
    if (format.missing.empty()) out += (out.empty() ? "" : ", ") + format.name;
  return out;
}

std::string versionText() {
  const dyn::Version version = dyn::version();
  return "dyn " + version.number + " (" + version.build_type + ")\ninstruction set " + version.instruction_set + "\nplugin interface " +
         std::to_string(version.plugin_interface) + "\nreads " + formats() +
         " and python; SRDF; meshes by assimp, octrees by octomap, broad phase by FCL";
}

int run(int argc, char** argv) {
  CLI::App app{"Kinematics and dynamics of robots; joints come from plugins.", "dyn"};
  app.set_help_flag("-h,--help", "prints this help");
  dyn::tool::addMessageOptions(app);
  app.require_subcommand(1);
  app.failure_message(dyn::tool::refusal);
  app.set_version_flag("--version", versionText, "prints the version, the instruction set, the plugin interface and what dyn reads");
  dyn::tool::addInfo(app);
  dyn::tool::addCheck(app);
  dyn::tool::addCodegen(app);
  dyn::tool::addCollide(app);
  dyn::tool::addCompute(app);
  dyn::tool::addConvert(app);
  dyn::tool::addDemo(app);
  dyn::tool::addDiff(app);
  dyn::tool::addAccuracy(app);
  dyn::tool::addBench(app);
  dyn::tool::addProfile(app);
  dyn::tool::addPlugin(app);
  dyn::tool::addSimulate(app);
  dyn::tool::addSweep(app);
  dyn::tool::addTruth(app);
  dyn::tool::addHelp(app);
  dyn::tool::addCompletion(app);
  try {
    app.parse(argc, argv);
  } catch (const dyn::tool::ExitCode& exit) {
    return exit.code;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const std::exception& e) {
    const bool memory = dynamic_cast<const std::bad_alloc*>(&e) != nullptr;
    dyn::tool::error(memory ? "memory ran out; ask for less: a part of the model, fewer states, or fewer algorithms (--only)" : e.what());
    return dyn::tool::Interruption::pending() ? dyn::tool::Interruption::exitCode() : 1;
  }
  return 0;
}

/// Set when main() ends the process. If the process ends before, code that it loaded has ended it.
bool ending = false;

void reportForeignEnd() {
  if (ending) return;
  dyn::tool::error("loaded code has ended the process; `dyn plugin check FILE.so` names it");
  _exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  std::atexit(reportForeignEnd);
  // A write to a closed pipe then fails like any other write. Programs that dyn starts do not inherit a handler.
  std::signal(SIGPIPE, [](int) {});
  // An exception of a plugin's function has already been reported where it was caught.
  std::set_terminate([] {
    dyn::tool::error("an exception reached where none may be thrown; the process ends");
    _exit(1);
  });
  const int code = run(argc, argv);
  ending = true;
  // Output may still be in a buffer. The exit code must tell if it cannot be written, for example because the disk is full.
  if (!dyn::tool::outputLost()) return code;
  dyn::tool::error("not all of the output could be written: its disk is full or its reader has ended");
  return code == 0 ? 1 : code;
}
