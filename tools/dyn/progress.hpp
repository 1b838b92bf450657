// SPDX-License-Identifier: BSD-2-Clause
// A progress bar for long work, shown on terminals only.
#pragma once

#include <unistd.h>

#include <cstdio>
#include <string>

namespace dyn::tool {

class ProgressLine {
 public:
  ProgressLine(double from, double to, const char* unit) : from_(from), to_(to), unit_(unit), shown_(isatty(STDERR_FILENO) != 0) {}
  ~ProgressLine() {
    if (shown_) std::fprintf(stderr, "\r\033[K");
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;
  void at(double t) {
    if (to_ <= from_) return;
    const int now = static_cast<int>(40 * (t - from_) / (to_ - from_));
    if (!shown_ || now == bars_) return;
    bars_ = now;
    const std::string bar(static_cast<std::size_t>(now), '#');
    std::fprintf(stderr, "\r[%-40s] %g %s", bar.c_str(), t, unit_);
    std::fflush(stderr);
  }

 private:
  double from_, to_;
  const char* unit_;
  bool shown_;
  int bars_ = -1;
};

}  // namespace dyn::tool
