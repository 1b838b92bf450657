// SPDX-License-Identifier: BSD-2-Clause
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

constexpr int patience = 10;  ///< time limit for static constructors [s]

/// Returns what is wrong with the table of segments, which the loader follows without checking it; empty if nothing is. Parts beyond the file's end
/// kill the process that reads their pages. Parts beyond the memory reserved for the file make the loader write over what is loaded already.
std::string problemOfTables(const OpenFile& file) {
  const std::string bytes = file.content();
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header) return "";  // dlopen says what is wrong with such files
  std::memcpy(&header, bytes.data(), sizeof header);
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64) return "";
  std::vector<Elf64_Phdr> segments(header.e_phnum);
  const std::uint64_t size = sizeof(Elf64_Phdr) * segments.size();
  if (segments.empty() || header.e_phentsize != sizeof(Elf64_Phdr) || header.e_phoff > bytes.size() || size > bytes.size() - header.e_phoff)
    return "";
  std::memcpy(segments.data(), bytes.data() + header.e_phoff, size);
  constexpr std::uint64_t most = std::uint64_t{1} << 40;  // bytes of memory that a library may take
  std::uint64_t begin = most, end = 0;                    // the addresses that the loader reserves
  for (const Elf64_Phdr& s : segments) {
    if (s.p_offset > bytes.size() || s.p_filesz > bytes.size() - s.p_offset) return "the file is cut short";
    if (s.p_type != PT_LOAD) continue;
    if (s.p_vaddr < end || s.p_vaddr > most || s.p_memsz > most || s.p_memsz < s.p_filesz) return "the file's table of segments is damaged";
    begin = std::min(begin, s.p_vaddr);
    end = s.p_vaddr + s.p_memsz;
  }
  for (const Elf64_Phdr& s : segments) {
    // Thread variables that begin as zeros take no memory of the segments.
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
    dlclose(loaded);  // gives one reference back; the file was opened before and stays open
    return "";
  }
  // The report ends with this word, unless the plugin ends the process while it is opened.
  const std::string opened = "opened";
  const Trial trial = tryInProcess({.seconds = patience}, [&](const auto& report) {
    // A call through a pointer may throw, so the exception gets here. It leaves the loader locked, but the child ends at once.
    void* (*volatile open_library)(const char*, int) = &dlopen;
    void* library = nullptr;
    try {
      library = open_library(name.c_str(), RTLD_NOW | RTLD_LOCAL);  // if dlopen refuses the file, openPlugin() will say why
    } catch (const std::exception& e) {
      return report(std::string("a static constructor of it threw: ") + e.what());
    } catch (...) {
      return report("a static constructor of it threw something that is no exception of the standard library");
    }
    if (library != nullptr) try {
        read(library);
      } catch (...) {  // openPlugin() will meet the same exception
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
