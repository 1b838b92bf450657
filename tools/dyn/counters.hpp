// SPDX-License-Identifier: BSD-2-Clause
// The processor's event counters for this thread, where the system gives access to them.
#pragma once

#include <string>

namespace dyn::tool {

class Counters {
 public:
  Counters();
  ~Counters();
  Counters(const Counters&) = delete;
  Counters& operator=(const Counters&) = delete;

  /// Why the counters are not available; empty if they are.
  const std::string& problem() const { return problem_; }

  struct Reading {
    double instructions = 0, branch_misses = 0;
  };
  void start();
  /// The counts since start().
  Reading stop();

 private:
  int instructions_ = -1, branch_misses_ = -1;
  std::string problem_;
};

}  // namespace dyn::tool
