#include "joint/trial_load.hpp"

#include "trial_process.hpp"

#include <dlfcn.h>
#include <elf.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

namespace dyn {

namespace {

constexpr int patience = 10;  ///< [s] that static constructors may take

/// Tells what is wrong with tables that the loader would follow without a look: parts beyond the file's end, whose pages kill the process that reads
/// them, and parts beyond what it reserves for the file, with which it would write over what is loaded already. Empty if there is nothing.
std::string problemOfTables(const OpenFile& file) {
  const std::string bytes = file.content();
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header) return "";  // dlopen says what is wrong with these
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return "";
  std::vector<Elf64_Phdr> segments(header.e_phnum);
  const std::uint64_t size = sizeof(Elf64_Phdr) * segments.size();
  if (segments.empty() || header.e_phentsize != sizeof(Elf64_Phdr) || header.e_phoff > bytes.size() || size > bytes.size() - header.e_phoff)
    return "";
  std::memcpy(segments.data(), bytes.data() + header.e_phoff, size);
  constexpr std::uint64_t most = std::uint64_t{1} << 40;  // of memory that a library takes
  std::uint64_t begin = most, end = 0;                    // of what the loader reserves
  for (const Elf64_Phdr& s : segments) {
    if (s.p_offset > bytes.size() || s.p_filesz > bytes.size() - s.p_offset) return "the file is cut short";
    if (s.p_type != PT_LOAD) continue;
    if (s.p_vaddr < end || s.p_vaddr > most || s.p_memsz > most || s.p_memsz < s.p_filesz) return "the file's table of segments is damaged";
    begin = std::min(begin, s.p_vaddr);
    end = s.p_vaddr + s.p_memsz;
  }
  for (const Elf64_Phdr& s : segments) {
    // A thread's variables that begin as zeros are of no file's memory.
    const std::uint64_t own = s.p_type == PT_TLS ? s.p_filesz : s.p_memsz;
    if (own > 0 && s.p_type != PT_GNU_STACK && (s.p_vaddr < begin || s.p_vaddr > end || own > end - s.p_vaddr))
      return "the file's table of segments is damaged";
  }
  return "";
}

}  // namespace

std::string trialLoad(const OpenFile& file, const std::function<void(void* library)>& read) {
  if (std::string problem = problemOfTables(file); !problem.empty()) return problem;
  const std::string name = file.nameForLoader();
  if (void* loaded = dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NOLOAD)) {
    dlclose(loaded);  // one reference back; it has been opened before and stays
    return "";
  }
  // One word at the end of the report: that of a plugin which ends the process while it is opened has none.
  const std::string opened = "opened";
  const Trial trial = tryInProcess({.seconds = patience}, [&](const auto& report) {
    // Through a pointer that may throw, so that the exception gets here; the child ends at once, so the loader's lock matters to nobody.
    void* (*volatile open_library)(const char*, int) = &dlopen;
    void* library = nullptr;
    try {
      library = open_library(name.c_str(), RTLD_NOW | RTLD_LOCAL);  // what it refuses is said when it is opened for good
    } catch (const std::exception& e) {
      return report(std::string("a static constructor of it threw: ") + e.what());
    } catch (...) {
      return report("a static constructor of it threw something that is no std::exception");
    }
    if (library != nullptr) try {
        read(library);
      } catch (...) {  // as it will be when it is read for good
      }
    report(opened);
  });
  if (!trial.untried.empty()) return trial.untried;
  if (trial.report == opened) return "";
  if (!trial.report.empty()) return trial.report;
  if (trial.late) return "its static constructors do not end within " + std::to_string(patience) + " s";
  if (trial.signal != 0) return std::string("opening it, a static constructor of it, or reading its description crashes: ") + strsignal(trial.signal);
  return "a static constructor of it ended the process";
}

}  // namespace dyn
