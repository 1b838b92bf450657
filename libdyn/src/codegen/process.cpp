// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>

extern char** environ;

namespace dyn {

namespace {

/// Returns whether the child has ended, and stores its exit code.
bool reap(pid_t child, int options, ProcessResult& result) {
  int status = 0;
  const pid_t waited = waitpid(child, &status, options);
  const bool reaped_by_others = waited < 0 && errno == ECHILD;
  if (reaped_by_others || (waited == child && WIFEXITED(status))) result.exit_code = reaped_by_others ? 0 : WEXITSTATUS(status);
  return waited == child || reaped_by_others;
}

}  // namespace

ProcessResult runProcess(const std::vector<std::string>& command, double seconds) {
  ProcessResult result;
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return result;
  std::vector<char*> arguments;
  arguments.reserve(command.size() + 1);
  for (const std::string& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 1);
  posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  // The child gets its own process group: compilers start other programs, and a timeout ends them all.
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  // Compilers wait for the programs that they start, so SIGCHLD gets its default action even if this process ignores it.
  sigset_t child_ends;
  sigemptyset(&child_ends);
  sigaddset(&child_ends, SIGCHLD);
  posix_spawnattr_setsigdefault(&attributes, &child_ends);
  pid_t child = 0;
  result.started = posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ) == 0;
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(ends[1]);
  if (!result.started) {
    close(ends[0]);
    return result;
  }
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  bool open = true, ended = false;
  char chunk[4096];
  // Read until the output is closed and the program has ended: it may close its output long before it ends.
  while (open || !ended) {
    if (Clock::now() >= end) {
      result.timed_out = true;
      kill(-child, SIGKILL);
      break;
    }
    pollfd wait{open ? ends[0] : -1, POLLIN, 0};
    if (poll(&wait, 1, open ? 100 : 2) > 0) {
      const ssize_t n = read(ends[0], chunk, sizeof chunk);
      if (n > 0 && result.output.size() < 65536) result.output.append(chunk, static_cast<std::size_t>(n));
      open = n > 0 || (n < 0 && errno == EINTR);
    }
    if (!open && !ended) ended = reap(child, WNOHANG, result);
  }
  close(ends[0]);
  while (!ended) ended = reap(child, 0, result);
  return result;
}

}  // namespace dyn
