// What the processor counts of this thread, where the system lets a program ask.
#pragma once

#include <string>

namespace dyn::tool {

class Counters {
 public:
  Counters();
  ~Counters();
  Counters(const Counters&) = delete;
  Counters& operator=(const Counters&) = delete;

  /// Why there are none; empty if there are.
  const std::string& problem() const { return problem_; }

  struct Reading {
    double instructions = 0, branch_misses = 0;
  };
  void start();
  /// Since start.
  Reading stop();

 private:
  int instructions_ = -1, branch_misses_ = -1;
  std::string problem_;
};

}  // namespace dyn::tool
