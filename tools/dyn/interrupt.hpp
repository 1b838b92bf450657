// SPDX-License-Identifier: BSD-2-Clause
// Ctrl-C and TERM: the command writes the results so far and ends with exit code 130 or 143. A message tells the user, unless --quiet was given; a
// second signal ends the command at once.
#pragma once

#include "commands.hpp"
#include "messages.hpp"

#include <unistd.h>

#include <cerrno>
#include <csignal>

namespace dyn::tool {

/// Handles the two signals during its lifetime. Only one may exist at a time.
class Interruption {
 public:
  Interruption() {
    came() = 0;
    struct sigaction act {};
    act.sa_handler = [](int signal) {
      came() = signal;
      constexpr char text[] = "\ndyn: note: interrupted; dyn writes the results that are complete and ends. Press Ctrl-C again to end it at once.\n";
      const int error = errno;
      [[maybe_unused]] const ssize_t written = messageOptions().quiet ? 0 : write(STDERR_FILENO, text, sizeof text - 1);
      errno = error;
    };
    // Without SA_RESTART, a write to a full pipe would fail.
    act.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
    sigaction(SIGINT, &act, &before_int_);
    sigaction(SIGTERM, &act, &before_term_);
  }
  ~Interruption() {
    sigaction(SIGINT, &before_int_, nullptr);
    sigaction(SIGTERM, &before_term_, nullptr);
  }
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  explicit operator bool() const { return pending(); }
  /// Whether a signal has arrived during the lifetime of the present or last Interruption.
  static bool pending() { return came() != 0; }
  /// Makes a copy of the process, which has inherited the answer, begin anew.
  static void forget() { came() = 0; }
  /// Throws ExitCode if a signal has arrived. Called after all results are written.
  void end() const {
    if (*this) throw ExitCode{exitCode()};
  }
  /// As shells have it for a process that a signal ended.
  static int exitCode() { return 128 + came(); }

 private:
  static volatile std::sig_atomic_t& came() {
    static volatile std::sig_atomic_t signal = 0;
    return signal;
  }
  struct sigaction before_int_ {
  }, before_term_{};
};

}  // namespace dyn::tool
