#include "joint/trial_load.hpp"

#include "trial_process.hpp"

#include <dlfcn.h>
#include <elf.h>

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

}  // namespace

std::string trialLoad(const OpenFile& file, const std::function<void(void* library)>& read) {
  if (cutShort(file)) return "the file is cut short";
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
