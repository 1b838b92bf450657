// SPDX-License-Identifier: BSD-2-Clause
// The command dyn. Exit codes: 0 success; 1 the model, the input or the answer is wrong, or output was lost; 2 the command line is wrong.
#include "commands.hpp"
#include "options.hpp"

#include <dyn/error.hpp>
#include <dyn/version.hpp>

#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>

namespace {

/// If a word is no subcommand, prints it with the list of subcommands. Returns false if the error is another one.
bool explainUnknown(const CLI::App& app) {
  const CLI::App* inner = &app;
  while (!inner->get_subcommands().empty()) inner = inner->get_subcommands().front();
  const std::vector<const CLI::App*> known = inner->get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> rest = inner->remaining();
  if (known.empty() || rest.empty() || rest.front().starts_with('-')) return false;
  std::string names;
  for (const CLI::App* sub : known) names += (names.empty() ? "" : ", ") + sub->get_name();
  std::fprintf(stderr, "dyn: there is no subcommand '%s'; there are %s\n", rest.front().c_str(), names.c_str());
  return true;
}

std::string versionText() {
  const dyn::Version version = dyn::version();
  return "dyn " + version.number + " (" + version.build_type + ")\ninstruction set " + version.instruction_set + "\nplugin interface " +
         std::to_string(version.plugin_interface) + "\nreads URDF and SRDF; meshes by assimp, octrees by octomap, broad phase by FCL";
}

int run(int argc, char** argv) {
  CLI::App app{"Kinematics and dynamics of robots; joints come from plugins."};
  app.require_subcommand(1);
  app.failure_message(dyn::tool::refusal);
  app.set_version_flag("--version", versionText, "prints version, instruction set and plugin interface");
  dyn::tool::addInfo(app);
  dyn::tool::addCheck(app);
  dyn::tool::addCodegen(app);
  dyn::tool::addCollide(app);
  dyn::tool::addCompute(app);
  dyn::tool::addDemo(app);
  dyn::tool::addAccuracy(app);
  dyn::tool::addBench(app);
  dyn::tool::addProfile(app);
  dyn::tool::addPlugin(app);
  dyn::tool::addSimulate(app);
  dyn::tool::addTruth(app);
  try {
    app.parse(argc, argv);
  } catch (const dyn::tool::ExitCode& exit) {
    return exit.code;
  } catch (const CLI::RequiredError& e) {
    if (!explainUnknown(app)) app.exit(e);
    return 2;
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : 2;
  } catch (const dyn::Error& e) {
    std::fprintf(stderr, "dyn: %s\n", e.what());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fputs("dyn: memory ran out; ask for less: a part of the model, fewer states, or fewer algorithms (--only)\n", stderr);
    return 1;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "dyn: %s\n", e.what());
    return 1;
  }
  return 0;
}

/// Set when main() ends the process. If the process ends before, code that it loaded has ended it.
bool ending = false;

void reportForeignEnd() {
  if (ending) return;
  std::fputs("dyn: code that it loaded ended the process; `dyn plugin check FILE.so` says of what\n", stderr);
  _exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  std::atexit(reportForeignEnd);
  // An exception of a plugin's function has already been reported where it was caught.
  std::set_terminate([] {
    std::fputs("dyn: an exception reached where none may be thrown; the process ends\n", stderr);
    _exit(1);
  });
  const int code = run(argc, argv);
  ending = true;
  // Output may still be in a buffer. The exit code must tell if it cannot be written, for example because the disk is full.
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  std::fputs("dyn: not all of the output could be written\n", stderr);
  return code == 0 ? 1 : code;
}
