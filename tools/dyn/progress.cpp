// SPDX-License-Identifier: BSD-2-Clause
#include "progress.hpp"

#include "messages.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace dyn::tool {

namespace {

std::string timeText(double seconds) {
  const auto s = static_cast<long long>(std::ceil(std::min(seconds, 1e9)));
  if (s < 60) return std::to_string(s) + " s";
  if (s < 3600) return std::to_string(s / 60) + " min " + std::to_string(s % 60) + " s";
  return std::to_string(s / 3600) + " h " + std::to_string(s / 60 % 60) + " min";
}

std::size_t terminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

std::string progressText(double done, double total, const std::string& unit, double seconds, const std::string& what, std::size_t width) {
  constexpr int bar_width = 24;
  const double part = total > 0 ? std::clamp(done / total, 0.0, 1.0) : 0;
  const auto full = static_cast<std::size_t>(bar_width * part);
  char percent[16];
  std::snprintf(percent, sizeof percent, "%3.0f %%", std::floor(100 * part));
  std::string text = "[" + std::string(full, '#') + std::string(bar_width - full, '-') + "] " + percent;
  if (done > 0 && seconds > 0) {
    char rate[32];
    std::snprintf(rate, sizeof rate, "  %.3g ", done / seconds);
    text += rate + unit + "/s, " + timeText(seconds / done * std::max(total - done, 0.0)) + " left";
  }
  if (!what.empty()) text += "  " + what;
  return text.substr(0, width);
}

Progress::Progress(double total, std::string unit)
    : total_(total),
      unit_(std::move(unit)),
      shown_(isLiveTerminal() && !messageOptions().quiet),
      start_(Clock::now()),
      drawn_(start_ - std::chrono::hours(1)) {}

Progress::~Progress() { clearLiveLine(); }

void Progress::at(double done, const std::string& what) {
  if (!shown_) return;
  const auto now = Clock::now();
  if (what == what_ && now - drawn_ < std::chrono::milliseconds(100)) return;
  drawn_ = now;
  what_ = what;
  // In the last column, a terminal would begin a new line.
  showLiveLine(progressText(done, total_, unit_, std::chrono::duration<double>(now - start_).count(), what, terminalWidth() - 1));
}

}  // namespace dyn::tool
