// SPDX-License-Identifier: BSD-2-Clause
// Fuzzes the command dyn with URDF text. It must end by itself within a minute, with exit code 0, 1 or 2.
#include "fuzz.hpp"

#include <codegen/process.hpp>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

using namespace dyn;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string path = fuzz::scratchFolder() / "robot.urdf";
  std::ofstream(path, std::ios::binary).write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  static const std::vector<std::string> commands[] = {{"check"},
                                                      {"info"},
                                                      {"demo"},
                                                      {"simulate", "--time", "0.01"},
                                                      {"simulate", "--time", "0.01", "--limits", "--integrator", "dormand_prince"},
                                                      {"collide", "--skip-missing"},
                                                      {"simulate", "--time", "0.01", "--integrator", "radau5"}};
  std::vector<std::string> command{DYN_COMMAND};
  const std::vector<std::string>& words = commands[size % std::size(commands)];
  command.insert(command.end(), words.begin(), words.end());
  command.push_back(path);
  if (size % 2) command.insert(command.end(), {"--root", "free_flyer"});
  const ProcessResult result = runProcess(command, 60);
  if (!result.started) std::abort();
  if (result.timed_out) fuzz::finding("dyn " + words[0] + " does not end");
  if (result.exit_code != 0 && result.exit_code != 1 && result.exit_code != 2)
    fuzz::finding("dyn " + words[0] + " ends with " + std::to_string(result.exit_code) + ": " + result.output);
  return 0;
}
