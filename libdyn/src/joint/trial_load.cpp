#include "joint/trial_load.hpp"

#include <dlfcn.h>
#include <elf.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <exception>
#include <fstream>
#include <vector>

namespace dyn {

namespace {

/// What the file's own tables say. One that is not understood counts as having constructors: dlopen will judge it, in the child first.
struct Anatomy {
  bool constructors = true;
  bool cut_short = false;  ///< mapped as its tables say, it would be read beyond its end, which kills the process
};

Anatomy examine(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const auto end = static_cast<std::uint64_t>(file.tellg());
  const auto read = [&](std::uint64_t offset, void* to, std::size_t size) {
    file.seekg(static_cast<std::streamoff>(offset));
    return static_cast<bool>(file.read(static_cast<char*>(to), static_cast<std::streamsize>(size)));
  };
  Elf64_Ehdr header;
  if (!read(0, &header, sizeof header) || std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return {};
  bool constructors = false;
  for (unsigned i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr segment;
    if (!read(header.e_phoff + std::uint64_t(i) * header.e_phentsize, &segment, sizeof segment)) return {};
    if (segment.p_offset > end || segment.p_filesz > end - segment.p_offset) return {true, true};
    for (std::uint64_t at = 0; segment.p_type == PT_DYNAMIC && at + sizeof(Elf64_Dyn) <= segment.p_filesz; at += sizeof(Elf64_Dyn)) {
      Elf64_Dyn entry;
      if (!read(segment.p_offset + at, &entry, sizeof entry)) return {};
      if (entry.d_tag == DT_NULL) break;
      // One entry is put there by the compiler's own start files.
      constructors = constructors || (entry.d_tag == DT_INIT_ARRAYSZ && entry.d_un.d_val > sizeof(void*));
    }
  }
  return {constructors, false};
}

/// The child's whole life. Reports one line: "" for opened or refused by dlopen, or what was thrown.
[[noreturn]] void openInChild(const std::string& path, int report) {
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
    open_library(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  } catch (const std::exception& e) {
    say((std::string("a static constructor of it threw: ") + e.what()).c_str());
  } catch (...) {
    say("a static constructor of it threw something that is no std::exception");
  }
  say("");
  _exit(0);
}

/// What the child wrote, up to its end or the deadline. `answered`: it wrote at all.
std::string readReport(int pipe, bool& answered, bool& ended) {
  std::string text;
  answered = ended = false;
  while (true) {
    pollfd ready{pipe, POLLIN, 0};
    const int n = poll(&ready, 1, 10'000);
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

std::string trialLoad(const std::string& path) {
  const Anatomy anatomy = examine(path);
  if (anatomy.cut_short) return "the file is cut short";
  if (!anatomy.constructors) return "";
  if (void* loaded = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD)) {
    dlclose(loaded);  // one reference back; it has been opened before and stays
    return "";
  }
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return "";
  const pid_t child = fork();
  if (child == 0) openInChild(path, ends[1]);
  close(ends[1]);
  bool answered = false, ended = false;
  std::string report = child > 0 ? readReport(ends[0], answered, ended) : std::string();
  close(ends[0]);
  if (child < 0) return "";
  if (!ended) kill(child, SIGKILL);
  int status = 0;
  pid_t waited;
  do waited = waitpid(child, &status, 0);
  while (waited < 0 && errno == EINTR);
  if (answered || !ended) return report;
  // It ended without a word. Someone else may have reaped it; then how is not known.
  if (waited == child && WIFSIGNALED(status))
    return std::string("opening it, or a static constructor of it, crashes: ") + strsignal(WTERMSIG(status));
  return "a static constructor of it ended the process";
}

}  // namespace dyn
