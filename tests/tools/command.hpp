// SPDX-License-Identifier: BSD-2-Clause
// Runs the command dyn as a user does and returns its answer to a line of arguments.
#pragma once

#include "support/folder.hpp"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace dyn::test {

inline const std::string biped = DYN_SOURCE_DIR "/models/biped.urdf";

inline std::string textOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

struct Answer {
  int code;
  std::string out, err;
};

inline Answer run(const std::string& arguments) {
  const Folder folder;
  const std::filesystem::path out = folder.path / "out", err = folder.path / "err";
  const std::string command = "'" DYN_BINARY_DIR "/bin/dyn' " + arguments + " >'" + out.string() + "' 2>'" + err.string() + "' </dev/null";
  const int status = std::system(command.c_str());
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), textOf(out), textOf(err)};
}

/// A state file for the biped with a floating base.
inline const std::string zero_state = R"({"samples":[{"q":[0,0,0,0,0,0,1)" + [] {
  std::string rest;
  for (int i = 0; i < 16; ++i) rest += ",0.1";
  return rest;
}() + "]}]}";

}  // namespace dyn::test
