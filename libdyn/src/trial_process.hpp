// SPDX-License-Identifier: BSD-2-Clause
// Does work that may crash, never end or exhaust memory in a process of its own, which reports what it found.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <string>

namespace dyn {

struct TrialLimits {
  double seconds;
  rlim_t memory = RLIM_INFINITY;  ///< bytes, in addition to what the process has already
};

struct Trial {
  std::string untried;  ///< why no child was started; empty if one was
  std::string report;   ///< everything that the child reported
  bool late = false;    ///< the child had not ended when the time was up
  int signal = 0;       ///< the signal that ended the child; 0 also if the child was waited for elsewhere
};

namespace detail {

/// Sets the limits. The child calls this before it works.
inline void confineTrial(const TrialLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a child in an endless loop must not survive its parent
  // The output of libraries that crash is dropped: the parent says what happened.
  if (const int null = open("/dev/null", O_WRONLY); null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
  }
  for (const int fatal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) ::signal(fatal, SIG_DFL);
  rlim_t pages = 0;
  if (limits.memory == RLIM_INFINITY || !(std::ifstream("/proc/self/statm") >> pages)) return;
  rlimit most{};
  getrlimit(RLIMIT_AS, &most);
  const rlim_t wanted = pages * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + limits.memory;
  if (most.rlim_cur == RLIM_INFINITY || wanted < most.rlim_cur) most.rlim_cur = wanted;
  setrlimit(RLIMIT_AS, &most);
}

/// Reads what the child reports, until it has ended or its time is up.
inline void listenToTrial(int pipe, double seconds, Trial& trial) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (true) {
    pollfd ready{pipe, POLLIN, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    const int n = left > 0 ? poll(&ready, 1, static_cast<int>(left)) : 0;
    if (n < 0 && errno == EINTR) continue;
    trial.late = n <= 0;
    if (trial.late) return;
    char buffer[1 << 16];
    const ssize_t size = read(pipe, buffer, sizeof buffer);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return;
    trial.report.append(buffer, static_cast<std::size_t>(size));
  }
}

}  // namespace detail

/// Calls work(report) in a child, where report(text) adds to the trial's report. The child then ends, without destructors of globals.
template <class Work>
Trial tryInProcess(const TrialLimits& limits, const Work& work) {
  Trial trial;
  const auto cannot = [&](const char* what) {
    trial.untried = std::string("it cannot be tried in a process of its own first: no ") + what + ", " + std::strerror(errno);
  };
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) {
    cannot("pipe");
    return trial;
  }
  const pid_t child = fork();
  if (child == 0) {
    detail::confineTrial(limits);
    work([&](const std::string& text) {
      for (std::size_t done = 0; done < text.size();) {
        const ssize_t n = write(ends[1], text.data() + done, text.size() - done);
        if (n < 0 && errno != EINTR) _exit(1);
        if (n > 0) done += static_cast<std::size_t>(n);
      }
    });
    _exit(0);
  }
  if (child < 0) {
    cannot("process");
    close(ends[0]);
    close(ends[1]);
    return trial;
  }
  close(ends[1]);
  detail::listenToTrial(ends[0], limits.seconds, trial);
  close(ends[0]);
  if (trial.late) kill(child, SIGKILL);
  int status = 0;
  pid_t waited;
  do waited = waitpid(child, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (waited == child && WIFSIGNALED(status)) trial.signal = WTERMSIG(status);
  return trial;
}

}  // namespace dyn
