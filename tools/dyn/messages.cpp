// SPDX-License-Identifier: BSD-2-Clause
#include "messages.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace dyn::tool {

namespace {

bool live_line = false;

bool isDumb() {
  const char* terminal = std::getenv("TERM");
  return terminal != nullptr && std::strcmp(terminal, "dumb") == 0;
}

bool hasColour(std::FILE* stream) {
  const std::string& color = messageOptions().color;
  if (color != "auto") return color == "always";
  const char* none = std::getenv("NO_COLOR");
  return (none == nullptr || *none == '\0') && !isDumb() && isatty(fileno(stream)) != 0;
}

void print(const std::string& command, Style style, const char* word, const std::string& text) {
  clearLiveLine();
  std::fprintf(stderr, "%s: %s %s\n", command.c_str(), styled(stderr, style, word).c_str(), text.c_str());
}

}  // namespace

MessageOptions& messageOptions() {
  static MessageOptions options;
  return options;
}

std::string styled(std::FILE* stream, Style style, const std::string& text) {
  if (!hasColour(stream)) return text;
  const char* const code = style == Style::error ? "1;31" : style == Style::warning ? "1;35" : style == Style::note ? "1;36" : "1";
  return std::string("\033[") + code + "m" + text + "\033[0m";
}

std::string heading(const std::string& text) { return styled(stdout, Style::heading, text); }

bool isLiveTerminal() { return isatty(STDERR_FILENO) != 0 && !isDumb(); }

void showLiveLine(const std::string& text) {
  std::fprintf(stderr, "\r%s\033[K", text.c_str());
  std::fflush(stderr);
  live_line = true;
}

void clearLiveLine() {
  if (!live_line) return;
  std::fputs("\r\033[K", stderr);
  live_line = false;
}

void error(const std::string& text) { error("dyn", text); }
void error(const std::string& command, const std::string& text) { print(command, Style::error, "error:", text); }
void warning(const std::string& text) {
  if (!messageOptions().quiet) print("dyn", Style::warning, "warning:", text);
}
void note(const std::string& text) {
  if (!messageOptions().quiet) print("dyn", Style::note, "note:", text);
}

void detail(const std::string& text) {
  if (!messageOptions().verbose) return;
  clearLiveLine();
  std::fprintf(stderr, "dyn: %s\n", text.c_str());
}

void detail(const std::string& text, std::chrono::steady_clock::duration time) {
  if (!messageOptions().verbose) return;
  const double seconds = std::chrono::duration<double>(time).count();
  char length[32];
  std::snprintf(length, sizeof length, seconds < 1 ? "%.3g ms" : "%.3g s", seconds < 1 ? 1e3 * seconds : seconds);
  detail(text + " in " + length);
}

bool outputLost() { return std::fflush(stdout) != 0 || std::ferror(stdout) != 0; }

}  // namespace dyn::tool
