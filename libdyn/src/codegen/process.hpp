// Another program, run to its end.
#pragma once

#include <string>
#include <vector>

namespace dyn {

struct ProcessResult {
  bool started = false, timed_out = false;
  int exit_code = -1;
  std::string output;  ///< of both streams, the first 64 kB
};

/// Looks the program up in PATH, without a shell.
ProcessResult runProcess(const std::vector<std::string>& command, double seconds);

}  // namespace dyn
