// SPDX-License-Identifier: BSD-2-Clause
// Runs another program to its end.
#pragma once

#include <string>
#include <vector>

namespace dyn {

struct ProcessResult {
  bool started = false, timed_out = false;
  /// -1 if a signal ended the program. 0 also if this process ignores SIGCHLD or waits for its children elsewhere: the exit code is then unknown, and
  /// the caller must check what the program made.
  int exit_code = -1;
  std::string output;  ///< the first 64 kB of standard output and error together
};

/// Looks the program up in PATH and runs it without a shell. After `seconds` it is killed together with the processes that it started.
ProcessResult runProcess(const std::vector<std::string>& command, double seconds);

}  // namespace dyn
