// SPDX-License-Identifier: BSD-2-Clause
#include "codegen/compiler.hpp"

#include "codegen/process.hpp"
#include "digest.hpp"

#include <dyn/error.hpp>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <sstream>

namespace dyn {

namespace {

namespace fs = std::filesystem;

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

/// The compiler's answer to --version. Each compiler is run once. Throws Error(compiler) if it cannot be run.
std::string versionOf(std::vector<std::string> command) {
  const std::string compiler = joined(command);
  static std::mutex mutex;
  static std::map<std::string, std::string> known;
  const std::lock_guard lock(mutex);
  if (const auto found = known.find(compiler); found != known.end()) return found->second;
  command.push_back("--version");
  const ProcessResult r = runProcess(command, 10);
  if (!r.started || r.exit_code != 0)
    throw Error(ErrorCode::compiler, "there is no compiler '" + compiler +
                                         "'; install one (apt install g++), or name it: CC or NativeOptions::compiler for C, CXX or "
                                         "JointPluginOptions::compiler for C++");
  return known[compiler] = r.output;
}

/// The processor's features. Code for one processor may not run on another.
std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  std::string line;
  while (std::getline(info, line))
    if (line.starts_with("flags") || line.starts_with("Features")) return line;
  return "";
}

class Workshop {
 public:
  explicit Workshop(const ObjectCache& cache) : path(cache.workshop()) {}
  ~Workshop() {
    std::error_code error;
    fs::remove_all(path, error);
  }
  Workshop(const Workshop&) = delete;
  Workshop& operator=(const Workshop&) = delete;
  const fs::path path;
};

}  // namespace

std::vector<std::string> compilerCommand(const std::string& given, const char* variable, const char* usual) {
  if (!given.empty()) return {given};
  const char* text = secure_getenv(variable);
  std::istringstream stream(text != nullptr ? text : "");
  // It may have several words, as in a makefile: "ccache gcc".
  std::vector<std::string> words{std::istream_iterator<std::string>(stream), {}};
  return words.empty() ? std::vector<std::string>{usual} : words;
}

std::string entryName(const CompilerTask& task) {
  std::string identity = task.source + versionOf(task.words) + processor() + task.identity;
  for (const auto* list : {&task.words, &task.flags})
    for (const std::string& word : *list) identity += '\0' + word;
  return task.prefix + digest(identity);
}

OpenFile compileInto(const ObjectCache& cache, const std::string& entry, const CompilerTask& task) {
  const Workshop workshop(cache);
  const fs::path source = workshop.path / task.file, object = workshop.path / "code.so";
  std::ofstream file(source);
  file << task.source;
  file.close();
  if (!file) throw Error(ErrorCode::file, "cannot be written", {source.string(), 0, ""});
  std::vector<std::string> command = task.words;
  command.insert(command.end(), task.flags.begin(), task.flags.end());
  command.insert(command.end(), {"-o", object.string(), source.string(), "-lm"});
  const ProcessResult r = runProcess(command, task.seconds);
  if (r.timed_out)
    throw Error(ErrorCode::compiler, task.what + task.size + " was not compiled within " + std::to_string(task.seconds) + " s; " + task.remedy);
  if (!r.started || r.exit_code != 0 || !fs::exists(object))
    throw Error(ErrorCode::compiler, task.what + " was not compiled by " + joined(task.words) + ": " + r.output.substr(0, 2000));
  cache.enter(entry, object);
  if (auto found = cache.find(entry)) return std::move(*found);
  throw Error(ErrorCode::compiler, task.what + " was compiled, but is not what was entered into the cache of compiled functions");
}

}  // namespace dyn
