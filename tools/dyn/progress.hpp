// SPDX-License-Identifier: BSD-2-Clause
// The progress of long work: a bar with rate and time left on standard error. It is shown on terminals only, and not with --quiet.
#pragma once

#include <chrono>
#include <string>

namespace dyn::tool {

/// The line for work of which `done` of `total` units were done in so many seconds. It is cut at `width` characters.
std::string progressText(double done, double total, const std::string& unit, double seconds, const std::string& what, std::size_t width);

class Progress {
 public:
  Progress(double total, std::string unit);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// So much is done; `what` names what comes next. Draws at most ten times a second, unless `what` changes.
  void at(double done, const std::string& what = "");

 private:
  using Clock = std::chrono::steady_clock;
  double total_;
  std::string unit_, what_;
  bool shown_;
  Clock::time_point start_, drawn_;
};

}  // namespace dyn::tool
