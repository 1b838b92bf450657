#include "joint/trial_load.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>

namespace dyn {

namespace {

constexpr int patience = 10;  ///< [s] that static constructors may take

/// Whether its own tables say that it goes on beyond its end: mapped like this it would kill the process that reads it.
bool cutShort(const OpenFile& file) {
  const std::string bytes = file.content();
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header) return false;
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return false;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    const std::uint64_t at = header.e_phoff + std::uint64_t(i) * header.e_phentsize;
    if (at > bytes.size() || sizeof segment > bytes.size() - at) return false;  // dlopen says what is wrong with it
    std::memcpy(&segment, bytes.data() + at, sizeof segment);
    if (segment.p_offset > bytes.size() || segment.p_filesz > bytes.size() - segment.p_offset) return true;
  }
  return false;
}

/// The child's whole life. Reports one line: "" for opened or refused by dlopen, or what was thrown.
[[noreturn]] void openInChild(const std::string& name, int report) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // whoever ends the parent does not mean to leave this one looping
  const auto say = [&](const char* text) {
    if (::write(report, text, std::strlen(text) + 1) < 0) _exit(1);
    _exit(0);
  };
  // The runtime's last words, and the plugin's, are not the user's business: the parent says what happened.
  if (const int null = open("/dev/null", O_WRONLY); null >= 0) {
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
  }
  for (const int fatal : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL}) signal(fatal, SIG_DFL);
  // Through a pointer that may throw, so that the exception gets here; the child ends at once, so the loader's lock matters to nobody.
  void* (*volatile open_library)(const char*, int) = &dlopen;
  try {
    open_library(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  } catch (const std::exception& e) {
    say((std::string("a static constructor of it threw: ") + e.what()).c_str());
  } catch (...) {
    say("a static constructor of it threw something that is no std::exception");
  }
  say("");
  _exit(0);
}

/// What the child wrote before it ended or the time was up. `answered`: it wrote at all.
std::string readReport(int pipe, bool& answered, bool& ended) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(patience);
  std::string text;
  answered = ended = false;
  while (true) {
    pollfd ready{pipe, POLLIN, 0};
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    const int n = left > 0 ? poll(&ready, 1, static_cast<int>(left)) : 0;
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return text;
    char buffer[512];
    const ssize_t size = read(pipe, buffer, sizeof buffer);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) {
      ended = true;
      return text.substr(0, text.find('\0'));
    }
    answered = true;
    text.append(buffer, static_cast<std::size_t>(size));
  }
}

}  // namespace

std::string trialLoad(const OpenFile& file) {
  if (cutShort(file)) return "the file is cut short";
  const std::string name = file.nameForLoader();
  if (void* loaded = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD)) {
    dlclose(loaded);  // one reference back; it has been opened before and stays
    return "";
  }
  const auto untried = [](const char* what) {
    return std::string("it cannot be tried in a process of its own first: no ") + what + ", " + std::strerror(errno);
  };
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return untried("pipe");
  const pid_t child = fork();
  if (child == 0) openInChild(name, ends[1]);
  const std::string why = child < 0 ? untried("process") : "";
  close(ends[1]);
  bool answered = false, ended = false;
  const std::string report = child > 0 ? readReport(ends[0], answered, ended) : std::string();
  close(ends[0]);
  if (child < 0) return why;
  if (!ended) kill(child, SIGKILL);
  int status = 0;
  pid_t waited;
  do waited = waitpid(child, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (!ended && !answered) return "its static constructors do not end within " + std::to_string(patience) + " s";
  if (answered) return report;
  // It ended without a word. Someone else may have reaped it; then how is not known.
  if (waited == child && WIFSIGNALED(status))
    return std::string("opening it, or a static constructor of it, crashes: ") + strsignal(WTERMSIG(status));
  return "a static constructor of it ended the process";
}

}  // namespace dyn
