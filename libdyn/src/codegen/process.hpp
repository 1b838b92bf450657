// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

namespace dyn {

struct ProcessResult {
  bool started = false, timed_out = false;
  /// -1: ended by a signal. 0 also where this process ignores SIGCHLD or waits for all its children, and nobody knows: judge by what it made.
  int exit_code = -1;
  std::string output;  ///< of both streams, the first 64 kB
};

/// Looks the program up in PATH, without a shell.
ProcessResult runProcess(const std::vector<std::string>& command, double seconds);

}  // namespace dyn
