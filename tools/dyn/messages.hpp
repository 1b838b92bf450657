// SPDX-License-Identifier: BSD-2-Clause
// Messages on standard error, and the rules for colour: --quiet, --verbose and --color decide what is shown and how.
#pragma once

#include <chrono>
#include <cstdio>
#include <string>
#include <type_traits>

namespace dyn::tool {

/// The options that every subcommand has.
struct MessageOptions {
  bool quiet = false, verbose = false;
  std::string color = "auto";
};
MessageOptions& messageOptions();

enum class Style { error, warning, note, heading };
/// Returns the text in the style's colour if the stream shows colours, and unchanged otherwise. With --color=auto the stream must be a terminal, TERM
/// must not be "dumb" and NO_COLOR must not be set (https://no-color.org).
std::string styled(std::FILE* stream, Style style, const std::string& text);
/// The same for a heading of a report on standard output.
std::string heading(const std::string& text);

/// Whether standard error is a terminal on which a line can be written again and again.
bool isLiveTerminal();
/// Writes a line that the next message or line replaces. clearLiveLine() removes it, if there is one, before other output.
void showLiveLine(const std::string& text);
void clearLiveLine();

/// Prints "dyn: error: TEXT". Errors are always shown.
void error(const std::string& text);
/// Prints "COMMAND: error: TEXT".
void error(const std::string& command, const std::string& text);
/// Prints "dyn: warning: TEXT" and "dyn: note: TEXT", unless --quiet was given.
void warning(const std::string& text);
void note(const std::string& text);
/// Prints "dyn: TEXT" if --verbose was given.
void detail(const std::string& text);
/// Prints "dyn: TEXT in 1.2 ms" if --verbose was given.
void detail(const std::string& text, std::chrono::steady_clock::duration time);

/// Returns the step's result. With --verbose it prints what was done, and how long it took.
template <class Step>
auto timed(const std::string& text, Step&& step) {
  const auto start = std::chrono::steady_clock::now();
  if constexpr (std::is_void_v<decltype(step())>) {
    step();
    detail(text, std::chrono::steady_clock::now() - start);
  } else {
    auto result = step();
    detail(text, std::chrono::steady_clock::now() - start);
    return result;
  }
}

/// Whether output to standard output has been lost, because its disk is full or its reader has ended. Flushes what is in the buffer.
bool outputLost();

}  // namespace dyn::tool
