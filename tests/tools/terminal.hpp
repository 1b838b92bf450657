// SPDX-License-Identifier: BSD-2-Clause
// Runs the command dyn on a terminal of its own and returns what a user would see there.
#pragma once

#include "command.hpp"

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

namespace dyn::test {

/// Runs a shell command whose standard output and standard error are a terminal of 100 columns. The texts of both come together.
inline Answer runOnTerminal(const std::string& command) {
  winsize size{};
  size.ws_row = 24;
  size.ws_col = 100;
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  REQUIRE(child >= 0);
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
    _exit(127);
  }
  std::string text;
  char chunk[4096];
  // Reading fails when the last process on the terminal has ended.
  for (ssize_t n; (n = read(terminal, chunk, sizeof chunk)) > 0;) text.append(chunk, static_cast<std::size_t>(n));
  close(terminal);
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return {WEXITSTATUS(status), text, ""};
}

}  // namespace dyn::test
